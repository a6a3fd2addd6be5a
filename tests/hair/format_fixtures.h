// A small file of each hair format, written by hand, all with the same two strands of four vertices 5 cm apart.
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "bytes.h"

namespace pelage::test {

inline Bytes bytes_of(const std::string& text) {
  Bytes bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

inline std::vector<glm::vec3> fixture_vertices() {
  return {{0, 1, 0},          {0, 0.95F, 0},          {0, 0.9F, 0},          {0, 0.85F, 0},
          {0.0078125F, 1, 0}, {0.0078125F, 0.95F, 0}, {0.0078125F, 0.9F, 0}, {0.0078125F, 0.85F, 0}};
}

inline Bytes plain_hair() {
  Bytes bytes = hair_header(2, 8, 2, 3);
  for (const glm::vec3& p : fixture_vertices()) append(bytes, p);
  return bytes;
}

inline Bytes plain_tfx() {
  Bytes bytes(160);
  put(bytes, 0, 4.0F);
  put(bytes, 4, std::uint32_t{2});
  put(bytes, 8, std::uint32_t{4});
  put(bytes, 12, std::uint32_t{160});
  for (const glm::vec3& p : fixture_vertices()) {
    append(bytes, p);
    append(bytes, 1.0F);
  }
  return bytes;
}

inline const std::string kTfxText =
    "version 2.0\nscale 1.0\nrotation 0 0 0\ntranslation 0 0 0\nbothEndsImmovable 0\nmaxNumVerticesInStrand 4\n"
    "numFollowHairsPerGuideHair 4\nmaxRadiusAroundGuideHair 0.5\nnumStrands 2\nis sorted 1\n"
    "strand 0 numVerts 4 texcoord 0.500000 000000\n"
    "0, 1, 0\n0, 0.95, 0\n0, 0.9, 0\n0, 0.85, 0\n"
    "strand 1 numVerts 4 texcoord 0.250000 000000\r\n"
    "0.0078125, 1, 0\n0.0078125, 0.95, 0\n0.0078125, 0.9, 0\n0.0078125, 0.85, 0\n";

/// @param extra  floats after each position: 0 for .data, 4 for CT2Hair
inline Bytes plain_data(int extra) {
  Bytes bytes;
  append(bytes, std::int32_t{2});
  const std::vector<glm::vec3> vertices = fixture_vertices();
  for (std::size_t k = 0; k < 8; ++k) {
    if (k % 4 == 0) append(bytes, std::int32_t{4});
    append(bytes, vertices[k]);
    for (int i = 0; i < extra; ++i) append(bytes, 0.0F);
  }
  return bytes;
}

/// hairutil's layout, with a list property and an element that no reader of hair needs.
inline const std::string kPlyHeader =
    " 1.0\ncomment x\nelement vertex 8\nproperty float x\nproperty float y\nproperty double z\nproperty uchar quality\n"
    "element strand 2\nproperty ushort nsegs\nelement face 1\nproperty list uchar short vertex_indices\n"
    "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n";

inline std::string ply_text() {
  return "ply\nformat ascii" + kPlyHeader +
         "0 1 0 7\n0 0.95 0 7\n0 0.9 0 7\n0 0.85 0 7\n0.0078125 1 0 7\n0.0078125 0.95 0 7\n0.0078125 0.9 0 7\n"
         "0.0078125 0.85 0 7\n3\n3\n2 0 1\n0 1\n";
}

inline Bytes ply_binary(bool big_endian) {
  Bytes bytes = bytes_of(std::string("ply\nformat binary_") + (big_endian ? "big" : "little") + "_endian" + kPlyHeader);
  const auto add = [&](auto value) {
    Bytes raw(sizeof value);
    std::memcpy(raw.data(), &value, sizeof value);
    if (big_endian) std::reverse(raw.begin(), raw.end());
    bytes.insert(bytes.end(), raw.begin(), raw.end());
  };
  for (const glm::vec3& p : fixture_vertices()) {
    add(p.x);
    add(p.y);
    add(static_cast<double>(p.z));
    add(std::uint8_t{7});
  }
  add(std::uint16_t{3});
  add(std::uint16_t{3});
  add(std::uint8_t{2});
  add(std::int16_t{0});
  add(std::int16_t{1});
  add(std::int32_t{0});
  add(std::int32_t{1});
  return bytes;
}

inline const std::string kObjText =
    "# two strands\no hair\nv 0 1 0\nv 0 0.95 0\nv 0 +0.9 0\nv 0 8.5e-1 0\nl 1 2 3 4\n"
    "v 0.0078125 1 0 1.0\nv 0.0078125 0.95 0\nv 0.0078125 0.9 0\nv 0.0078125 0.85 0\nl -4/1 -3/2 -2/3 8/4\r\n";

inline const std::string kUsdaText = R"(#usda 1.0
(
    "a { comment"
    metersPerUnit = 0.5
    upAxis = "Y"
    customLayerData = { string upAxis = "Z" }
)

def Xform "root" (
    kind = "component"
    prepend references = @./other.usda@</x>
)
{
    double3 xformOp:translate = (0, 0, 1)  # ignored {
    def Mesh "head" { point3f[] points = [(9, 9, 9)] }
    def BasisCurves "hair"
    {
        uniform token type = "linear"
        rel material:binding = </root/mat>
        float3[] extent
        int[] curveVertexCounts = [4, 4]
        point3f[] points = [(0, 2, 0), (0, 1.9, 0), (0, 1.8, 0), (0, 1.7, 0), (0.015625, 2, 0), (0.015625, 1.9, 0),
            (0.015625, 1.8, 0), (0.015625, 1.7, 0)] (
            doc = """a ) in """
        )
    }
}
)";

struct Fixture {
  std::string name;
  Bytes bytes;
};

inline std::vector<Fixture> fixtures() {
  return {{"a.hair", plain_hair()},      {"full.hair", small_hair()},        {"a.tfx", plain_tfx()},
          {"full.tfx", small_tfx()},     {"text.tfx", bytes_of(kTfxText)},   {"a.data", plain_data(0)},
          {"a.bin", plain_data(4)},      {"text.ply", bytes_of(ply_text())}, {"little.ply", ply_binary(false)},
          {"big.ply", ply_binary(true)}, {"a.obj", bytes_of(kObjText)},      {"a.usda", bytes_of(kUsdaText)}};
}

}  // namespace pelage::test
