// A structure given by its matrices alone, from any solver, and the parameters that scale their parts.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mottle/formats/matrices/matrix_file.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/parameters/parameter_targets.hpp"
#include "mottle/model/structures/sparse_structure.hpp"

namespace mottle::model {

/// One matrix and the powers of parameters that it is multiplied by.
struct ScaledMatrix {
  std::vector<ParameterPower> coefficient;  ///< ascending in parameter; empty: constant
  SparseMatrix lower;
};

/// K(x) and M(x) of a structure, each the sum of its terms, in one pattern.
struct SeparablePencil {
  SeparableMatrix stiffness, mass;
  std::vector<std::string> names;  ///< of the rows, or empty
};

/// Adds up terms of one coefficient and puts all in one pattern.
SeparablePencil make_pencil(const std::vector<ScaledMatrix>& stiffness, const std::vector<ScaledMatrix>& mass,
                            std::vector<std::string> names);

/// A part of a structure that parameters may scale, apart in stiffness and mass.
///
///   K_part(x) = (x / nominal)^exponent K,   M_part(x) = (x / nominal)^exponent M
struct MatrixPart {
  std::string name;
  std::optional<SymmetricMatrix> stiffness = {};
  std::optional<SymmetricMatrix> mass = {};
  std::optional<double> nominal = {};  ///< value of the parameter at which the matrices were written; none: 1
  int exponent = 1;
};

/// The constant part of the matrices, and the parts that parameters scale.
struct MatrixSystem {
  std::optional<SymmetricMatrix> stiffness = {};
  std::optional<SymmetricMatrix> mass = {};
  std::vector<MatrixPart> parts;
};

/// A pencil with what a study wants to know of its parameters.
struct MatrixModel {
  SeparablePencil pencil;
  Eigen::VectorXd reference;            ///< where modes are numbered [parameter]
  std::vector<PhysicalLimit> limits;    ///< by parameter
  std::vector<std::string> notes = {};  ///< what a reader of the model should know
};

/// Binds parameters to parts by the targets "K:part" and "M:part"; a part that no target names stays as it was written.
///
/// Matrices with names are put together by them, those without by the number of their rows. Rows that a solver fixed by
/// a penalty are left out. The reference of a parameter is 1 for a factor, the nominal value where all its parts state
/// the same one, its entry of `fallback` otherwise.
///
/// Throws InvalidInput: a target that is none of these (with those there are), a matrix that two parameters scale, a
/// nominal value <= 0, matrices of different size without names, no stiffness or no mass at all.
MatrixModel bind_parameters(const MatrixSystem& system, const std::vector<ParameterTargets>& parameters,
                            const Eigen::VectorXd& fallback);

/// K(x) and M(x) as sums of known powers of x times matrices. Degrees of freedom go by the names of the rows, or by
/// their number from 1 where there are none. Rows that share a name are the layers of an expanded shell or beam: its
/// displacement is their mean.
class MatrixStructure final : public SparseStructure {
 public:
  /// @param reference  where modes are numbered [parameter]
  MatrixStructure(SeparablePencil pencil, Eigen::VectorXd reference);

  Eigen::Index parameter_count() const override { return reference_.size(); }
  Eigen::Index mode_count() const override { return pencil_.stiffness.pattern.rows(); }
  int find_degree_of_freedom(const std::string& name) const override;
  std::string unknown_degree_of_freedom(const std::string& name) const override;
  ObservationMatrix observation(const std::vector<int>& degrees_of_freedom) const override;
  /// Of a translation along x; along whichever axis there are names for, nan without names.
  double total_mass(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;
  std::vector<std::string> description(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;
  std::string parameter_role(Eigen::Index parameter) const override { return separable_role(parameter); }

  const Eigen::VectorXd& reference() const override { return reference_; }
  const SeparableMatrix& stiffness_terms() const override { return pencil_.stiffness; }
  const SeparableMatrix& mass_terms() const override { return pencil_.mass; }
  /// Numbers of 14 digits, or what is left of them in a fit to several matrices.
  double entry_rounding() const override { return 1e-12; }
  std::string equation_name(int row) const override;

 private:
  SeparablePencil pencil_;
  Eigen::VectorXd reference_;
  std::map<std::string, int> numbers_;    // of names, into the next
  std::vector<std::vector<int>> layers_;  // rows of each name
};

}  // namespace mottle::model
