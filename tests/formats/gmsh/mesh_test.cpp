// Meshes that Gmsh 4.8 wrote from the .geo files beside this test, and mistakes.
#include "mottle/formats/gmsh/mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/message_of.hpp"
#include "mottle/core/error.hpp"

namespace mottle::formats {
namespace {

using test::message_of;
using ::testing::HasSubstr;

const std::string k_folder = std::string(MOTTLE_SOURCE_DIR) + "/tests/formats/gmsh/";

const GmshMesh::Group& group(const GmshMesh& mesh, const std::string& name) {
  return *std::ranges::find(mesh.groups, name, &GmshMesh::Group::name);
}

/// Positions of the nodes of each element of a group.
std::set<std::vector<double>> places(const GmshMesh& mesh, const std::string& name) {
  std::set<std::vector<double>> all;
  for (const std::size_t element : group(mesh, name).elements) {
    std::vector<double> one;
    for (const std::size_t node : mesh.nodes_of(mesh.elements[element])) {
      const Eigen::Vector3d& at = mesh.nodes[node].position;
      one.insert(one.end(), at.begin(), at.end());
    }
    all.insert(one);
  }
  return all;
}

TEST(GmshMesh, HasTheGroupsOfTheGeometry) {
  const GmshMesh mesh = read_gmsh_mesh(k_folder + "plate41.msh");
  EXPECT_EQ(mesh.nodes.size(), 117U);
  ASSERT_EQ(mesh.groups.size(), 4U);
  EXPECT_EQ(mesh.groups[0].name, "corner");
  EXPECT_EQ(mesh.groups[0].tag, 9);
  EXPECT_EQ(group(mesh, "plate").elements.size(), 96U);
  EXPECT_EQ(group(mesh, "edges").elements.size(), 40U);
  EXPECT_EQ(group(mesh, "left edge").elements.size(), 8U);
  EXPECT_EQ(mesh.elements[group(mesh, "plate").elements[0]].kind->name, "4-node quadrangle");
}

TEST(GmshMesh, IsTheSameInBothVersions) {
  const GmshMesh now = read_gmsh_mesh(k_folder + "plate41.msh");
  const GmshMesh before = read_gmsh_mesh(k_folder + "plate22.msh");
  EXPECT_EQ(now.elements.size(), before.elements.size()) << "those of the left edge stand twice in the old file";
  for (const char* name : {"plate", "edges", "left edge", "corner"}) {
    EXPECT_EQ(places(now, name), places(before, name)) << name;
  }
}

TEST(GmshMesh, HoldsSecondOrderElements) {
  const GmshMesh mesh = read_gmsh_mesh(k_folder + "beam.msh");
  const GmshMesh::Element& element = mesh.elements[group(mesh, "bar").elements[0]];
  EXPECT_EQ(element.kind->name, "10-node tetrahedron");
  const auto nodes = mesh.nodes_of(element);
  const auto middle = [&](int a, int b) {
    return Eigen::Vector3d(0.5 * (mesh.nodes[nodes[static_cast<std::size_t>(a)]].position +
                                  mesh.nodes[nodes[static_cast<std::size_t>(b)]].position));
  };
  EXPECT_TRUE(mesh.nodes[nodes[8]].position.isApprox(middle(2, 3), 1e-12)) << "Gmsh has edge 34 before edge 24";
  EXPECT_TRUE(mesh.nodes[nodes[9]].position.isApprox(middle(1, 3), 1e-12));
}

struct Mistake {
  const char* text;
  const char* message;
};

constexpr const char* k_head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n2\n1 0 0 0\n2 1 0 0\n$EndNodes\n";

TEST(GmshMesh, RefusesWhatItCannotRead) {
  const std::string head = k_head;
  for (const Mistake& each :
       {Mistake{"*NODE\n", "a.msh:1: this is no mesh of Gmsh"},
        Mistake{"$MeshFormat\n4 0 8\n", "a.msh:2: version 4 of MSH is not read; save it as 4.1 or 2.2"},
        Mistake{"$MeshFormat\n4.1 1 8\n", "a.msh:2: the mesh is binary; save it as text"},
        Mistake{"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PartitionedEntities\n", "a.msh:4: the mesh is partitioned"},
        Mistake{"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n", "there is no $Nodes"},
        Mistake{"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n900000000\n1 0 0 0\n",
                "a.msh:5: the number of nodes is 900000000, more than the file holds"},
        Mistake{"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 nan 0\n", "a.msh:6: 'nan' stands where"},
        Mistake{"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n2\n1 0 0 0\n1 1 0 0\n$EndNodes\n",
                "node 1 stands twice"},
        Mistake{"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Comment\n", "$Comment has no $EndComment"}}) {
    EXPECT_THAT(message_of<FormatError>([&] { parse_gmsh_mesh(each.text, "a.msh"); }), HasSubstr(each.message));
  }
}

TEST(GmshMesh, RefusesElementsThatCannotBe) {
  for (const Mistake& each :
       {Mistake{"$Elements\n1\n1 1 2 5 1 1 3\n", "a.msh:11: element 1 names node 3"},
        Mistake{"$Elements\n1\n1 1 2 5 1 1 1\n", "a.msh:11: element 1 has a node twice"},
        Mistake{"$Elements\n1\n1 99 2 5 1 1 2\n", "a.msh:11: elements of Gmsh's type 99"},
        Mistake{"$Elements\n2\n1 1 2 5 1 1 2\n1 1 2 6 1 2 1\n$EndElements\n", "element 1 stands twice"},
        Mistake{"$Elements\n1\n1 1 2 0 1 1 2\n$EndElements\n", "no element is in a physical group"},
        Mistake{"$Elements\n1\n1 1 2 5 1 1\n", "the file ends where"}}) {
    const std::string text = std::string(k_head) + each.text;
    EXPECT_THAT(message_of<FormatError>([&] { parse_gmsh_mesh(text, "a.msh"); }), HasSubstr(each.message)) << each.text;
  }
}

}  // namespace
}  // namespace mottle::formats
