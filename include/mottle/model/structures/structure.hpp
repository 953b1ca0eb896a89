// A structure with parameters: its degrees of freedom, its mass and how the parameters enter. Its equations are solved
// by a Solver.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <string>
#include <vector>

#include "mottle/core/subject.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {
struct FiniteElementModel;
}  // namespace mottle::fem

namespace mottle::model {

/// B, which gives displacements at degrees of freedom from those of the equations: u = B phi. Forces f at the degrees
/// of freedom are B' f on the equations. The row of a fixed degree of freedom is empty.
using ObservationMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// B of a structure whose equations are its degrees of freedom.
ObservationMatrix selected_equations(const std::vector<int>& degrees_of_freedom, Eigen::Index equations);

/// Stiffness, mass and damping as functions of the parameters, or an external program that knows them. Shapes have
/// a row for each equation; the degrees of freedom that a user names are found by number and read off by an
/// ObservationMatrix.
class Structure {
 public:
  virtual ~Structure() = default;

  virtual Eigen::Index parameter_count() const = 0;
  /// Equations, or modes where no more is known: the most modes there can be.
  virtual Eigen::Index mode_count() const = 0;
  virtual bool is_damped() const { return false; }
  /// Whether loads can be put on it: a program that gives modes alone has no stiffness matrix here.
  virtual bool has_stiffness() const { return true; }

  /// Number of a degree of freedom by its name, or -1.
  virtual int find_degree_of_freedom(const std::string& name) const = 0;
  /// "'m9' is not known here; ...": what a wrong name is answered with.
  virtual std::string unknown_degree_of_freedom(const std::string& name) const = 0;
  /// B of these degrees of freedom: [degree of freedom x equation].
  virtual ObservationMatrix observation(const std::vector<int>& degrees_of_freedom) const = 0;
  /// Components of shapes [equation x mode] at degrees of freedom: [degree of freedom x mode].
  Eigen::MatrixXd displacements(const Eigen::Ref<const Eigen::MatrixXd>& shapes,
                                const std::vector<int>& degrees_of_freedom) const {
    return observation(degrees_of_freedom) * shapes;
  }

  /// Total mass at one parameter vector; nan where it is not known.
  virtual double total_mass(const Eigen::Ref<const Eigen::VectorXd>& parameters) const = 0;
  /// Description of the structure as it was read, in lines for `check`.
  virtual std::vector<std::string> description(const Eigen::Ref<const Eigen::VectorXd>& parameters) const = 0;
  /// How a parameter enters: "linearly: no re-assembly".
  virtual std::string parameter_role(Eigen::Index parameter) const = 0;

  /// Grid points and elements, for drawing and for directions of measured components; null: it has none. Where it has,
  /// component c of node i is degree of freedom 6 i + c.
  virtual const FiniteElementModel* mesh() const { return nullptr; }
};

/// Numbers of degrees of freedom by their names.
///
/// @param subject  of which they are, for errors
/// @throws InvalidInput  one that the structure does not have (says which it has), one given twice, none at all
std::vector<int> find_degrees_of_freedom(const Structure& structure, const std::vector<std::string>& names,
                                         const Subject& subject);

}  // namespace mottle::model
