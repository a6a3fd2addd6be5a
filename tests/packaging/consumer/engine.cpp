// An engine's view: pelage::runtime alone gives its boxes.
#include <pelage/data_schema/scene.h>
#include <pelage/satf/model.h>

int main() {
  return pelage::material_preset("red").name == "red" ? 0 : 1;
}
