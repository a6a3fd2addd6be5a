#include <pelage/data_schema/hairstyle.h>
#include <pelage/satf/model.h>

int main(int, char** argv) {
  const pelage::Hairstyle style = pelage::load_hairstyle(argv[1]);
  return pelage::make_model(style, pelage::BakeSettings{}, 32).instances.size() == 3 ? 0 : 1;
}
