// PSHELL with MID4: a plate whose middle lies beside its nodes, said by the coupling or by the offset.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/message_of.hpp"
#include "fem/models.hpp"
#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

/// One slanted element, of four or eight nodes.
test::ModelMaker plate(int node_count) {
  constexpr double k_places[8][2] = {{0, 0}, {2, 0}, {2.4, 1}, {0.4, 1}, {1, 0}, {2.2, 0.5}, {1.4, 1}, {0.2, 0.5}};
  test::ModelMaker maker;
  const int metal = maker.material(1, 2.0, 0.3, 1.0);
  maker.shell_property(1, metal, 0.1);
  ShellElement element{.id = 1, .node_count = node_count, .property = 0};
  for (int k = 0; k < node_count; ++k)
    element.nodes[static_cast<std::size_t>(k)] = maker.node(k + 1, {k_places[k][0], k_places[k][1], 0.0});
  maker.model.elements<ShellElement>().push_back(element);
  maker.model.settings.automatic_constraints = AutomaticConstraints::none;
  return maker;
}

/// Twice the energy of constant strains and curvatures.
double energy(const FiniteElementModel& model) {
  const Eigen::MatrixXd K = test::dense(assemble(model, {}).stiffness.at(Eigen::VectorXd()));
  Eigen::VectorXd motion = Eigen::VectorXd::Zero(K.rows());
  for (std::size_t n = 0; n < model.nodes.size(); ++n) {
    const double x = model.nodes[n].position.x(), y = model.nodes[n].position.y();
    motion.segment<6>(6 * static_cast<int>(n)) << 0.1 * x + 0.02 * y, -0.3 * y, 0.5 * x * x + 0.2 * x * y, 0.2 * x,
        -x - 0.2 * y, -0.01;
  }
  return motion.dot(K * motion);
}

// G4 = -1/T^2 integral of z G dz: with G4 = c G1 the middle lies at z = -c T, and I is T^3/12 + (c T)^2 T.
TEST(CoupledShell, IsThePlateWithAnOffset) {
  constexpr double k_shift = 0.4;
  for (const int nodes : {4, 8}) {
    test::ModelMaker coupled = plate(nodes), offset = plate(nodes);
    coupled.model.shell_properties[0].coupling_material = coupled.material(2, 2.0 * k_shift, 0.3, 0.0);
    coupled.model.shell_properties[0].bending_ratio = 1.0 + 12.0 * k_shift * k_shift;
    offset.model.elements<ShellElement>()[0].offset = -0.1 * k_shift;
    EXPECT_NEAR(energy(coupled.model) / energy(offset.model), 1.0, 1e-12) << nodes;
    EXPECT_GT(std::abs(energy(plate(nodes).model) / energy(offset.model) - 1.0), 0.01);
  }
}

TEST(CoupledShell, RefusesACouplingThatGivesEnergyAway) {
  test::ModelMaker coupled = plate(4);
  coupled.model.shell_properties[0].coupling_material = coupled.material(2, 2.0, 0.3, 0.0);
  EXPECT_NE(test::message_of<InvalidInput>([&] { assemble(coupled.model, {}); }).find("MID4 couples membrane"),
            std::string::npos);
}

TEST(CoupledShell, IsAssembledAnewForItsModuliAndThickness) {
  test::ModelMaker coupled = plate(4);
  coupled.model.shell_properties[0].coupling_material = coupled.material(2, 0.2, 0.3, 0.0);
  const std::array fields = {coupled.model.materials[0].young, coupled.model.materials[1].young,
                             coupled.model.shell_properties[0].thickness, coupled.model.materials[0].density};
  std::vector<FieldParameter> parameters;
  for (const FieldIndex field : fields) parameters.push_back({.fields = {field}, .is_factor = true});
  EXPECT_EQ(assemble(coupled.model, parameters).is_separable, (std::vector<bool>{false, false, false, true}));
}

}  // namespace
}  // namespace mottle::fem
