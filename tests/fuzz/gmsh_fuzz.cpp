// libFuzzer target for formats/gmsh: whatever the bytes, a mesh is refused with FormatError or keeps its promises.
// Seeds: tests/formats/gmsh.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "mottle/core/error.hpp"
#include "mottle/formats/gmsh/mesh.hpp"

namespace {

using namespace mottle;
using namespace mottle::formats;

void expect(bool claim) {
  if (!claim) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  GmshMesh mesh;
  try {
    mesh = parse_gmsh_mesh({reinterpret_cast<const char*>(data), size}, "fuzz.msh");
  } catch (const FormatError&) {
    return 0;
  }
  expect(!mesh.groups.empty());
  for (std::size_t k = 0; k < mesh.nodes.size(); ++k) {
    expect(mesh.nodes[k].position.allFinite());
    expect(k == 0 || mesh.nodes[k - 1].tag < mesh.nodes[k].tag);
  }
  for (const GmshMesh::Element& element : mesh.elements) {
    for (const std::size_t node : mesh.nodes_of(element)) expect(node < mesh.nodes.size());
  }
  for (const GmshMesh::Group& group : mesh.groups) {
    expect(!group.elements.empty());
    for (const std::size_t element : group.elements) {
      expect(element < mesh.elements.size() && mesh.elements[element].kind->dimension == group.dimension);
    }
  }
  return 0;
}
