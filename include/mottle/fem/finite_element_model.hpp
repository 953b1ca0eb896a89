// A finite-element model as plain data: what a bulk data deck says, resolved to indices and basic coordinates.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "mottle/fem/card_field.hpp"
#include "mottle/fem/elements/element_table.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// A local coordinate system, resolved to basic coordinates.
struct CoordinateSystem {
  enum class Kind : std::uint8_t { rectangular, cylindrical, spherical };

  int id = 0;
  Kind kind = Kind::rectangular;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns: x, y, z axis in basic coordinates

  /// Basic coordinates of a point given in this system (angles in degrees).
  Eigen::Vector3d to_basic(const Eigen::Vector3d& local) const;
  /// Directions of the system's components at a basic point, as columns (radial, tangential... where curvilinear).
  Eigen::Matrix3d directions_at(const Eigen::Vector3d& position) const;
};

/// A grid point (six degrees of freedom) or a scalar point (one, component 1).
struct Node {
  int id = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< basic
  int displacement_system = -1;                        ///< index into coordinate_systems; -1: basic
  bool is_scalar = false;
};

/// MAT1, MAT2, MAT8, MAT9.
struct Material {
  enum class Kind : std::uint8_t {
    isotropic,          ///< MAT1: two of young, shear, poisson are given (the third follows), or all three
    anisotropic_shell,  ///< MAT2: moduli G11 G12 G13 G22 G23 G33, plane stress xx yy xy
    orthotropic_shell,  ///< MAT8: moduli E1 E2 NU12 G12 G1Z G2Z
    anisotropic_solid,  ///< MAT9: moduli G11 G12 ... G66, the upper triangle by rows; xx yy zz xy yz zx
  };

  int id = 0;
  FieldIndex young = k_no_field, shear = k_no_field, poisson = k_no_field, density = k_no_field;
  Kind kind = Kind::isotropic;
  std::vector<FieldIndex> moduli = {};  ///< of the other kinds
};

/// RBE2: the components of the dependent nodes move as one rigid body with the independent node.
struct RigidBody {
  int id = 0;
  int independent = -1;
  Components components = 0;
  std::vector<int> dependents = {};
};

/// RBAR: a rigid link whose six independent components may lie at both ends.
struct RigidBar {
  int id = 0;
  std::array<int, 2> nodes = {-1, -1};
  std::array<Components, 2> independent = {};
  std::array<Components, 2> dependent = {};
};

/// RBE3: the reference components follow the weighted mean motion of the others.
struct Interpolation {
  struct Source {
    int node = -1;
    Components components = 0;
    double weight = 1.0;
  };

  int id = 0;
  int reference = -1;
  Components reference_components = 0;
  std::vector<Source> sources = {};
  std::vector<std::pair<int, Components>> dependents = {};  ///< UM; empty: the reference components
};

/// MPC: sum of coefficient times displacement = 0; the first term is the dependent one.
struct MultipointEquation {
  struct Term {
    int node = -1;
    int component = 0;  ///< 0..5
    double coefficient = 0.0;
  };

  std::vector<Term> terms = {};
};

/// Which degrees of freedom are constrained although the model does not say so.
enum class AutomaticConstraints : std::uint8_t {
  none,
  null,  ///< that neither stiffness nor mass acts on: they have no mode (PARAM,AUTOSPC,NO)
  soft,  ///< that have no stiffness compared with their node's other ones (PARAM,AUTOSPC,YES)
};

/// The parts of a deck that say how it is to be solved.
struct AnalysisSettings {
  AutomaticConstraints automatic_constraints = AutomaticConstraints::soft;
  bool coupled_mass = false;                                 ///< PARAM,COUPMASS > 0: consistent instead of lumped mass
  double mass_factor = 1.0;                                  ///< PARAM,WTMASS
  double drilling = 100.0;                                   ///< PARAM,K6ROT
  int reference_node = -1;                                   ///< PARAM,GRDPNT: index of a node; -1: basic origin
  int modes = 0;                                             ///< EIGRL ND; 0: not given
  double lowest_frequency = -1.0, highest_frequency = -1.0;  ///< EIGRL V1, V2 (Hz); negative: not given
};

/// The whole model.
struct FiniteElementModel {
  std::vector<CardField> fields;
  std::vector<CoordinateSystem> coordinate_systems;
  std::vector<Node> nodes;  ///< ascending in id
  std::vector<Material> materials;
  std::vector<ShellProperty> shell_properties;
  std::vector<BeamProperty> beam_properties;
  ElementLists element_lists;
  std::vector<RigidBody> rigid_bodies;
  std::vector<RigidBar> rigid_bars;
  std::vector<Interpolation> interpolations;
  std::vector<MultipointEquation> multipoint_equations;
  std::vector<std::pair<int, Components>> fixed;  ///< SPC and permanent constraints: node index, components
  /// ASET and OMIT, node index and components: the mass of the omitted degrees of freedom follows the others
  /// statically. Where an analysis set is given, all that is neither in it nor constrained is omitted.
  std::vector<std::pair<int, Components>> analysis_set, omitted_set;
  AnalysisSettings settings;

  /// The elements of one kind.
  template <typename Element>
  std::vector<Element>& elements() {
    return std::get<std::vector<Element>>(element_lists);
  }
  template <typename Element>
  const std::vector<Element>& elements() const {
    return std::get<std::vector<Element>>(element_lists);
  }
  /// Value of a field, or `otherwise` where the card leaves it out.
  double value(FieldIndex field, double otherwise = 0.0) const {
    return field == k_no_field ? otherwise : fields[static_cast<std::size_t>(field)].value;
  }
  /// Index of the node with that id, or -1.
  int find_node(int id) const;
};

}  // namespace mottle::fem
