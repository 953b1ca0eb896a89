// A finite-element model as plain data: what a bulk data deck says, resolved to indices and basic coordinates.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace mottle {

/// A number on a card that a parameter may act on: "MAT1:2:E". A card's number is read from here at every assembly.
struct CardField {
  std::string card;  ///< "MAT1", "PELAS", "CONM2": in capitals
  int id = 0;
  std::string name;  ///< "E", "RHO", "K1": in capitals, as in the format's documentation
  double value = 0.0;
};

/// Index into FiniteElementModel::fields; k_no_field where the card leaves the number out (zero, or as documented).
using FieldIndex = int;
inline constexpr FieldIndex k_no_field = -1;

/// Degrees of freedom 1..6 of a grid point as bits 0..5.
using Components = std::uint8_t;
inline constexpr Components k_all_components = 0x3f;

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

/// MAT1. Two of young, shear, poisson are given (the third follows), or all three.
struct Material {
  int id = 0;
  FieldIndex young = k_no_field, shear = k_no_field, poisson = k_no_field, density = k_no_field;
};

enum class SolidShape : std::uint8_t { hexahedron8, wedge6, tetrahedron4, tetrahedron10 };

/// CHEXA, CPENTA, CTETRA with PSOLID.
struct SolidElement {
  int id = 0, property_id = 0;
  SolidShape shape = SolidShape::hexahedron8;
  std::array<int, 10> nodes = {};  ///< indices into nodes
  int material = -1;               ///< index into materials
};

/// PSHELL. A material of -1 leaves that stiffness out (MID2 blank: no bending; MID3 blank: no shear flexibility).
struct ShellProperty {
  int id = 0;
  int membrane_material = -1, bending_material = -1, shear_material = -1;
  FieldIndex thickness = k_no_field;
  double bending_ratio = 1.0;      ///< 12 I / T^3
  double shear_ratio = 5.0 / 6.0;  ///< TS / T
  FieldIndex nonstructural_mass = k_no_field;
};

/// CQUAD4 (4 nodes) and CTRIA3 (3).
struct ShellElement {
  int id = 0;
  int node_count = 4;
  std::array<int, 4> nodes = {};
  int property = -1;
  double offset = 0.0;                ///< ZOFFS, along the element's normal
  FieldIndex thickness = k_no_field;  ///< own thickness (mean of T1..T4 where given), else the property's
};

/// PBAR, PBEAM (constant section), PBARL and PBEAML (numbers follow from the dimensions).
struct BeamProperty {
  std::string card;  ///< "PBAR", "PBARL", ...
  int id = 0;
  int material = -1;
  FieldIndex area = k_no_field, inertia_1 = k_no_field, inertia_2 = k_no_field, inertia_12 = k_no_field,
             torsion = k_no_field, nonstructural_mass = k_no_field;
  double shear_1 = 0.0, shear_2 = 0.0;  ///< K1, K2: shear area / area; 0: rigid in shear
  std::string section;                  ///< "ROD", "BAR", "TUBE", ... of PBARL; empty: the numbers above are given
  std::vector<FieldIndex> dimensions;   ///< DIM1...
};

/// CBAR, CBEAM.
struct BeamElement {
  std::string card;
  int id = 0;
  std::array<int, 2> nodes = {};
  int property = -1;
  Eigen::Vector3d orientation = Eigen::Vector3d::UnitZ();  ///< v, basic: plane 1 is spanned by the axis and v
  std::array<Eigen::Vector3d, 2> offsets = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};  ///< WA, WB, basic
  std::array<Components, 2> pins = {};  ///< released components at ends A and B, in element axes
};

/// CROD with PROD, CONROD.
struct RodElement {
  int id = 0;
  std::array<int, 2> nodes = {};
  int material = -1;
  FieldIndex area = k_no_field, torsion = k_no_field, nonstructural_mass = k_no_field;
};

/// CELAS, CMASS, CDAMP: one number between two degrees of freedom, or one and ground (node -1).
struct ScalarElement {
  enum class Kind : std::uint8_t { spring, mass, damper };

  Kind kind = Kind::spring;
  int id = 0;
  std::array<int, 2> nodes = {-1, -1};
  std::array<int, 2> components = {0, 0};  ///< 0..5
  FieldIndex value = k_no_field;
};

/// CBUSH with PBUSH.
struct BushElement {
  int id = 0;
  std::array<int, 2> nodes = {-1, -1};                 ///< second -1: ground
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< element axes as columns, basic
  Eigen::Vector3d location = Eigen::Vector3d::Zero();  ///< where the springs sit, basic
  std::array<FieldIndex, 6> stiffness = {-1, -1, -1, -1, -1, -1};
  std::array<FieldIndex, 6> damping = {-1, -1, -1, -1, -1, -1};
};

/// CONM2 (mass, offset, inertia about its centre of gravity) and CONM1 (a whole 6 x 6 matrix).
struct PointMassElement {
  std::string card;
  int id = 0;
  int node = -1;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();            ///< in which offset, inertia or matrix are given
  FieldIndex mass = k_no_field;                                  ///< CONM2
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();              ///< CONM2, node to centre of gravity, in `axes`
  std::array<FieldIndex, 6> inertia = {-1, -1, -1, -1, -1, -1};  ///< CONM2: I11 I21 I22 I31 I32 I33 (as on the card)
  std::vector<FieldIndex> matrix = {};                           ///< CONM1: 21 of the lower triangle, by rows
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

/// The parts of a deck that say how it is to be solved.
struct AnalysisSettings {
  bool automatic_constraints = true;                         ///< PARAM,AUTOSPC
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
  std::vector<SolidElement> solids;
  std::vector<ShellProperty> shell_properties;
  std::vector<ShellElement> shells;
  std::vector<BeamProperty> beam_properties;
  std::vector<BeamElement> beams;
  std::vector<RodElement> rods;
  std::vector<ScalarElement> scalars;
  std::vector<BushElement> bushes;
  std::vector<PointMassElement> point_masses;
  std::vector<RigidBody> rigid_bodies;
  std::vector<RigidBar> rigid_bars;
  std::vector<Interpolation> interpolations;
  std::vector<MultipointEquation> multipoint_equations;
  std::vector<std::pair<int, Components>> fixed;  ///< SPC and permanent constraints: node index, components
  AnalysisSettings settings;

  /// Value of a field, or `otherwise` where the card leaves it out.
  double value(FieldIndex field, double otherwise = 0.0) const {
    return field == k_no_field ? otherwise : fields[static_cast<std::size_t>(field)].value;
  }
  /// Index of the node with that id, or -1.
  int find_node(int id) const;
};

}  // namespace mottle
