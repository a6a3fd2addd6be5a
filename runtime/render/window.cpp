#include "pelage/render/window.h"
