#include "mottle/fem/elements/curved_shell.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "fem/elements/curved_shell_strains.hpp"
#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

using curved_shell::ParentPoint;
using curved_shell::Place;
using curved_shell::Shear;
using curved_shell::Strain;
using curved_shell::Surface;
using curved_shell::Tables;

/// How stiff in shear a section is taken to be that is rigid: times bending stiffness / area.
constexpr double k_rigid_shear = 1e4;
/// Stiffness of the membrane strains that 2 x 2 points miss, times bending stiffness / area.
constexpr double k_unseen_membrane = 0.1;

/// Direction of the material's x in the axes of a place.
Eigen::Vector2d material_x(const CurvedShellInput& input, const Place& place) {
  Eigen::Vector2d along = place.axes.topRows<2>() * place.tangents.col(0);
  if (!input.material_direction.isZero(0.0)) {
    along = place.axes.topRows<2>() * input.material_direction;
    require(along.norm() > 1e-6 * input.material_direction.norm(),
            "shell: the x axis of the material coordinate system is normal to the element, its projection has no "
            "direction; name another system (MCID) or give an angle (THETA)");
  }
  return Eigen::Rotation2Dd(input.material_angle) * along.normalized();
}

/// A section's stiffness in the axes of a place; `own_bending` is what of the bending remains where the membrane
/// follows the curvature: D - B A^-1 B.
struct LocalSection {
  Eigen::Matrix3d membrane, coupling, bending, own_bending;
  Eigen::Matrix2d shear;
};

LocalSection section_at(const CurvedShellInput& input, const ShellSection& section, const Place& place) {
  const Eigen::Vector2d x = material_x(input, place);
  const double c = x.x(), s = x.y();
  Eigen::Matrix3d strain;  // in material axes from that in the place's
  strain << c * c, s * s, c * s, s * s, c * c, -c * s, -2.0 * c * s, 2.0 * c * s, c * c - s * s;
  const Eigen::Matrix2d shear{{c, s}, {-s, c}};
  LocalSection local{.membrane = strain.transpose() * section.membrane * strain,
                     .coupling = strain.transpose() * section.coupling * strain,
                     .bending = strain.transpose() * section.bending * strain,
                     .own_bending = {},
                     .shear = shear.transpose() * section.shear * shear};
  local.own_bending = local.bending;
  if (!section.coupling.isZero(0.0))
    local.own_bending -= local.coupling.transpose() * local.membrane.ldlt().solve(local.coupling);
  return local;
}

/// Assumed fields of the element: membrane strain and shear at any point.
class Fields {
 public:
  explicit Fields(const Surface& surface) : surface_(surface) {
    const Tables& tables = surface.tables();
    const Eigen::Index columns = surface.size() + surface.inside();
    Eigen::MatrixXd samples = Eigen::MatrixXd::Zero(std::ssize(tables.shear_ties) + 2, columns);
    Eigen::Index row = 0;
    for (const curved_shell::Tie& tie : tables.shear_ties)
      samples.row(row++) = tie.direction.transpose() * surface.shear(tie.point);
    for (const ParentPoint& point : tables.points) samples.bottomRows(2) += point.weight * surface.shear(point);
    shear_ = tables.shear_fit * samples;
    for (const curved_shell::Tie& tie : tables.membrane_ties) {
      const Eigen::Vector2d& t = tie.direction;
      const Eigen::RowVector3d along(t.x() * t.x(), t.y() * t.y(), t.x() * t.y());
      ties_.push_back(along * surface.membrane(tie.point));
    }
    for (const ParentPoint& point : tables.reduced)
      reduced_.push_back(curved_shell::to_axes(surface.place(point)) * surface.membrane(point));
  }

  Shear shear(const ParentPoint& point, const Place& place) const {
    return place.inverse.transpose() *
           (curved_shell::shear_functions(surface_.tables().node_count, point.xi, point.eta) * shear_);
  }

  /// Of six nodes: the tied strain in the place's axes.
  Strain tied_membrane(const ParentPoint& point, const Place& place) const {
    Strain strain = Strain::Zero(3, surface_.size() + surface_.inside());
    for (int direction = 0; direction < 3; ++direction) {
      const Eigen::RowVector3d fit = curved_shell::linear_fit(surface_.tables(), direction, point.xi, point.eta);
      for (int k = 0; k < 3; ++k) strain.row(direction) += fit(k) * ties_[static_cast<std::size_t>(3 * direction + k)];
    }
    // Along y - x: xx + yy - twice xy.
    strain.row(2) = (strain.row(0) + strain.row(1) - strain.row(2)).eval();
    return curved_shell::to_axes(place) * strain;
  }

  /// Of eight nodes: the strain less the bilinear one that agrees with it at the reduced points.
  Strain unseen_membrane(const ParentPoint& point, const Place& place) const {
    Strain strain = curved_shell::to_axes(place) * surface_.membrane(point);
    const Eigen::RowVectorXd weights = curved_shell::extrapolation(surface_.tables(), point.xi, point.eta);
    for (std::size_t k = 0; k < reduced_.size(); ++k) strain -= weights(static_cast<Eigen::Index>(k)) * reduced_[k];
    return strain;
  }

 private:
  const Surface& surface_;
  Eigen::MatrixXd shear_;
  std::vector<Eigen::RowVectorXd> ties_;
  std::vector<Strain> reduced_;
};

/// Sums with the degrees of freedom inside.
struct Sums {
  Eigen::MatrixXd membrane, coupling, bending, shear;

  explicit Sums(Eigen::Index size)
      : membrane(Eigen::MatrixXd::Zero(size, size)), coupling(membrane), bending(membrane), shear(membrane) {}
};

/// Stretching and the curvature that it carries along: A, B, B A^-1 B.
void add_membrane(double area, const LocalSection& section, const Strain& strain, const Strain& curvature, Sums& sums) {
  sums.membrane.noalias() += strain.transpose() * (area * section.membrane) * strain;
  const Eigen::Matrix3d carried = area * (section.bending - section.own_bending);
  if (carried.isZero(0.0)) return;
  const Eigen::MatrixXd mixed = strain.transpose() * (area * section.coupling) * curvature;
  sums.coupling += mixed + mixed.transpose();
  sums.bending.noalias() += curvature.transpose() * carried * curvature;
}

Sums sums_of(const CurvedShellInput& input, const ShellSection& section, const Surface& surface) {
  const Fields fields(surface);
  const Tables& tables = surface.tables();
  const double area = surface.area();
  const bool is_rigid = section.shear.isZero(0.0), has_bending = !section.bending.isZero(0.0);
  const Eigen::Matrix2d rigid = k_rigid_shear / area * section.bending.trace() * Eigen::Matrix2d::Identity();
  Sums sums(surface.size() + surface.inside());
  const auto curvature_at = [&](const ParentPoint& point, const Place& place) {
    return Strain(curved_shell::to_axes(place) * surface.curvature(point));
  };
  for (const ParentPoint& point : tables.reduced) {
    const Place place = surface.place(point);
    add_membrane(point.weight * place.area, section_at(input, section, place),
                 curved_shell::to_axes(place) * surface.membrane(point), curvature_at(point, place), sums);
  }
  for (const ParentPoint& point : tables.points) {
    const Place place = surface.place(point);
    const LocalSection local = section_at(input, section, place);
    const double weight = point.weight * place.area;
    const Strain curvature = curvature_at(point, place);
    if (tables.reduced.empty()) {
      add_membrane(weight, local, fields.tied_membrane(point, place), curvature, sums);
    } else {
      const Strain unseen = fields.unseen_membrane(point, place);
      const Eigen::Matrix3d holding = has_bending ? Eigen::Matrix3d(local.own_bending / area) : local.membrane;
      (has_bending ? sums.bending : sums.membrane).noalias() +=
          unseen.transpose() * (k_unseen_membrane * weight * holding) * unseen;
    }
    sums.bending.noalias() += curvature.transpose() * (weight * local.own_bending) * curvature;
    const Shear shear = fields.shear(point, place);
    (is_rigid ? sums.bending : sums.shear).noalias() +=
        shear.transpose() * (weight * (is_rigid ? rigid : local.shear)) * shear;
  }
  return sums;
}

/// Motion of the bubbles with the nodes at least energy: [node and inside x node].
Eigen::MatrixXd follow(const Sums& sums, const ShellSection& section, Eigen::Index size) {
  // Relative to the membrane, or to the bending of what has none.
  const bool has_membrane = !section.membrane.isZero(0.0);
  const double bending = has_membrane ? section.bending_over_membrane : 1.0;
  Eigen::MatrixXd total = sums.membrane + sums.coupling + bending * sums.bending;
  if (!section.shear.isZero(0.0)) total += bending / section.bending_over_shear * sums.shear;
  const Eigen::Index inside = total.rows() - size;
  Eigen::VectorXd scale = total.diagonal().tail(inside).cwiseMax(0.0).cwiseSqrt();
  for (double& each : scale) each = each > 0.0 ? 1.0 / each : 0.0;  // nothing resists: it stays
  Eigen::Matrix4d own = Eigen::Matrix4d::Identity();
  own.topLeftCorner(inside, inside) = scale.asDiagonal() * total.bottomRightCorner(inside, inside) * scale.asDiagonal();
  Eigen::Matrix<double, 4, Eigen::Dynamic> by_nodes = Eigen::Matrix<double, 4, Eigen::Dynamic>::Zero(4, size);
  by_nodes.topRows(inside) = scale.asDiagonal() * total.bottomLeftCorner(inside, size);
  Eigen::MatrixXd motion = Eigen::MatrixXd::Identity(total.rows(), size);
  motion.bottomRows(inside) = -(scale.asDiagonal() * own.fullPivLu().solve(by_nodes).topRows(inside));
  return motion;
}

/// motion' matrix motion, symmetric to the last bit.
Eigen::MatrixXd moved(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& motion) {
  Eigen::MatrixXd result = motion.transpose() * matrix * motion;
  result.triangularView<Eigen::StrictlyUpper>() = result.transpose();
  return result;
}

}  // namespace

CurvedShellPieces curved_shell_stiffness(const CurvedShellInput& input, const ShellSection& section) {
  const Surface surface(input);
  const Sums sums = sums_of(input, section, surface);
  const Eigen::MatrixXd offset = surface.to_offset_nodes(input.offset);
  const Eigen::MatrixXd motion = follow(sums, section, surface.size()) * offset;
  Eigen::MatrixXd drilling = Eigen::MatrixXd::Zero(surface.size(), surface.size());
  for (const ParentPoint& point : surface.tables().points) {
    constexpr double fraction = 1e-6;  // of G t, at K6ROT = 1: as Nastran
    const Eigen::RowVectorXd lag = surface.drilling(point);
    drilling.noalias() += fraction * point.weight * surface.place(point).area * lag.transpose() * lag;
  }
  return {.membrane = moved(sums.membrane, motion),
          .coupling = moved(sums.coupling, motion),
          .bending = moved(sums.bending, motion),
          .shear = moved(sums.shear, motion),
          .drilling = moved(drilling, offset)};
}

Eigen::MatrixXd curved_shell_mass(const CurvedShellInput& input, MassKind kind) {
  const Surface surface(input);
  const Eigen::Index count = input.node_count;
  Eigen::MatrixXd shares = Eigen::MatrixXd::Zero(count, count);
  for (const ParentPoint& point : surface.tables().points)
    shares += point.weight * surface.place(point).area * point.values.transpose() * point.values;
  if (kind == MassKind::lumped)
    shares = Eigen::VectorXd(shares.diagonal() * (shares.sum() / shares.trace())).asDiagonal();
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(6 * count, 6 * count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) mass.block<3, 3>(6 * i, 6 * j).diagonal().setConstant(shares(i, j));
  }
  return moved(mass, surface.to_offset_nodes(input.offset));
}

double curved_shell_area(const CurvedShellInput& input) {
  return Surface(input).area();
}

ShellQuality curved_shell_quality(const CurvedShellInput& input) {
  const int corners = input.node_count / 2;
  ShellInput flat{.node_count = corners};
  flat.nodes.leftCols(corners) = input.nodes.leftCols(corners);
  ShellQuality quality = shell_quality(flat);
  const Tables& tables = curved_shell::tables(input.node_count);
  const auto across = [&](const ParentPoint& point) {
    const Eigen::Matrix<double, 3, 2> tangents = input.nodes.leftCols(input.node_count) * point.slopes.transpose();
    return Eigen::Vector3d(tangents.col(0).cross(tangents.col(1)));
  };
  const Eigen::Vector3d normal = across(tables.centre).normalized();
  double smallest = across(tables.centre).norm(), largest = smallest;
  for (const ParentPoint& node : tables.nodes) {
    const Eigen::Vector3d here = across(node);
    smallest = std::min(smallest, here.dot(normal) > 0.0 ? here.norm() : here.dot(normal));
    largest = std::max(largest, here.norm());
  }
  quality.jacobian_ratio = smallest / largest;
  return quality;
}

}  // namespace mottle::fem
