// Stiffness of the flat element of a shell from the stiffness of its section, which may depend on direction.
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>

#include "fem/elements/shell_flat.hpp"
#include "mottle/core/error.hpp"

namespace mottle::fem::shell {
namespace {

using Strain12 = Eigen::Matrix<double, 3, 12>;

/// Direction of the material's x in element axes.
Eigen::Vector2d material_x(const Flat& flat, const ShellInput& input) {
  Eigen::Vector2d along = flat.edges[0].tangent;
  if (!input.material_direction.isZero(0.0)) {
    along = flat.axes.topRows<2>() * input.material_direction;
    require(along.norm() > 1e-6 * input.material_direction.norm(),
            "shell: the x axis of the material coordinate system is normal to the element, its projection has no "
            "direction; name another system (MCID) or give an angle (THETA)");
    along.normalize();
  }
  return Eigen::Rotation2Dd(input.material_angle) * along;
}

/// Fraction of an edge's shear that becomes bending: that of minimum energy of a beam along the edge.
double fraction_of_bending(const Edge& edge, const ShellSection& section) {
  if (section.shear.isZero(0.0)) return 1.0;
  const Eigen::Vector2d& t = edge.tangent;
  const Eigen::Vector3d curved(t.x() * t.x(), t.y() * t.y(), 2.0 * t.x() * t.y());
  const double flexibility =
      section.bending_over_shear * curved.dot(section.bending * curved) / t.dot(section.shear * t);
  require(flexibility >= 0.0, "shell: a shear flexibility of {:g}, a number >= 0 is needed", flexibility);
  return 1.0 / (1.0 + 12.0 * flexibility / (edge.length * edge.length));
}

std::array<double, 4> fractions_of_bending(const Flat& flat, const ShellSection& section) {
  std::array<double, 4> fractions = {};
  for (std::size_t e = 0; e < static_cast<std::size_t>(flat.node_count); ++e)
    fractions[e] = fraction_of_bending(flat.edges[e], section);
  return fractions;
}

/// Makes room for the rotation about the normal among the rows, u and v by node.
PlaneMatrix with_drilling_rows(const Eigen::Matrix<double, 8, 12>& rows) {
  PlaneMatrix result = PlaneMatrix::Zero();
  for (Eigen::Index i = 0; i < 4; ++i) result.middleRows<2>(3 * i) = rows.middleRows<2>(2 * i);
  return result;
}

PlaneMatrix with_drilling(const Eigen::Matrix<double, 8, 8>& matrix) {
  Eigen::Matrix<double, 8, 12> rows = Eigen::Matrix<double, 8, 12>::Zero();
  for (Eigen::Index i = 0; i < 4; ++i) rows.middleCols<2>(3 * i) = matrix.middleCols<2>(2 * i);
  return with_drilling_rows(rows);
}

/// Sums over the integration points: nodes in plane, incompatible modes, nodes across the plane.
struct Sums {
  Eigen::Matrix<double, 8, 8> in_plane = Eigen::Matrix<double, 8, 8>::Zero();
  Eigen::Matrix<double, 8, 12> coupling = Eigen::Matrix<double, 8, 12>::Zero();
  Eigen::Matrix<double, 4, 8> modes_in_plane = Eigen::Matrix<double, 4, 8>::Zero();
  Eigen::Matrix<double, 4, 12> modes_coupling = Eigen::Matrix<double, 4, 12>::Zero();
  Eigen::Matrix4d modes = Eigen::Matrix4d::Zero();
};

Sums membrane_sums(const Flat& flat, const ShellSection& section, const PlateStrains& plate) {
  const MembraneStrains strains = membrane_strains(flat);
  const bool is_coupled = !section.coupling.isZero(0.0);
  Sums sums;
  for (Eigen::Index p = 0; p < flat.point_count; ++p) {
    const double area = flat.points[p].area;
    const Eigen::Matrix<double, 3, 8>& strain = strains.nodes[p];
    const Eigen::Matrix<double, 3, 4>& mode = strains.modes[p];
    const Eigen::Matrix<double, 3, 8> stress = area * section.membrane * strain;
    sums.in_plane.noalias() += strain.transpose() * stress;
    sums.modes_in_plane.noalias() += mode.transpose() * stress;
    sums.modes.noalias() += mode.transpose() * (area * section.membrane) * mode;
    if (!is_coupled) continue;
    const Strain12 coupled = area * section.coupling * plate.curvature[p];
    sums.coupling.noalias() += strain.transpose() * coupled;
    sums.modes_coupling.noalias() += mode.transpose() * coupled;
  }
  return sums;
}

}  // namespace

ShellSection in_element_axes(const Flat& flat, const ShellInput& input, const ShellSection& section) {
  const Eigen::Vector2d x = material_x(flat, input);
  const double c = x.x(), s = x.y();
  Eigen::Matrix3d strain;  // in material axes from that in element axes
  strain << c * c, s * s, c * s, s * s, c * c, -c * s, -2.0 * c * s, 2.0 * c * s, c * c - s * s;
  const Eigen::Matrix2d shear{{c, s}, {-s, c}};
  ShellSection turned = section;
  turned.membrane = strain.transpose() * section.membrane * strain;
  turned.coupling = strain.transpose() * section.coupling * strain;
  turned.bending = strain.transpose() * section.bending * strain;
  turned.shear = shear.transpose() * section.shear * shear;
  return turned;
}

SectionStiffness section_stiffness(const Flat& flat, const ShellSection& section) {
  const PlateStrains plate = plate_strains(flat, fractions_of_bending(flat, section));
  SectionStiffness result;
  for (Eigen::Index p = 0; p < flat.point_count; ++p) {
    const double area = flat.points[p].area;
    const Strain12 moment = area * section.bending * plate.curvature[p];
    result.bending.noalias() += plate.curvature[p].transpose() * moment;
    result.shear.noalias() += plate.shear[p].transpose() * (area * section.shear) * plate.shear[p];
  }
  if (section.membrane.isZero(0.0)) return result;
  Sums sums = membrane_sums(flat, section, plate);
  if (flat.node_count == 4) {
    const Eigen::LDLT<Eigen::Matrix4d> modes = sums.modes.ldlt();
    const Eigen::Matrix<double, 4, 8> followed = modes.solve(sums.modes_in_plane);
    sums.in_plane.noalias() -= sums.modes_in_plane.transpose() * followed;
    if (!section.coupling.isZero(0.0)) {
      sums.coupling.noalias() -= followed.transpose() * sums.modes_coupling;
      result.bending.noalias() -= sums.modes_coupling.transpose() * modes.solve(sums.modes_coupling);
    }
  }
  result.membrane = with_drilling(sums.in_plane);
  result.coupling = with_drilling_rows(sums.coupling);
  return result;
}

}  // namespace mottle::fem::shell
