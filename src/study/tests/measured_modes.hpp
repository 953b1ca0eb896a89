// Modes as a test of one specimen found them, whatever file they came from.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/formats/matrices/mat.hpp"
#include "mottle/formats/tables/csv.hpp"
#include "mottle/layers.hpp"
#include "mottle/study/input/study.hpp"

namespace mottle::study {

/// Where one row of measured shapes was measured: by name, or along a direction at a node.
struct MeasuredComponent {
  std::string name = {};  ///< of a degree of freedom of the model; empty: the following hold
  double sign = 1.0;
  int node = 0;
  bool is_rotation = false;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< global, of unit length
  int axis = 0;                                         ///< of the node's own axes, 0 to 2
};

/// One specimen.
struct MeasuredModes {
  std::string file = {};
  std::vector<MeasuredComponent> components = {};
  Eigen::VectorXd frequencies = {};   ///< in the study's unit [mode]; nan: not given
  Eigen::VectorXd damping = {};       ///< ratio [mode]; nan: not given
  Eigen::MatrixXd shapes = {};        ///< real [component x mode]; nan: not measured
  Eigen::VectorXd collinearity = {};  ///< of the shapes as measured [mode]
  std::vector<bool> is_scaled = {};   ///< mass-normalised, in the study's units [mode]
  bool has_own_axes = false;          ///< some node's axes are not the global ones

  bool has_shape(Eigen::Index mode) const { return !shapes.col(mode).array().isNaN().all(); }
};

/// "101:-Z" is the opposite of "101:+Z".
MeasuredComponent named_component(const std::string& name);

/// One specimen from the bytes of a universal file: datasets 55 and 2414. Components that are zero in every mode were
/// not measured. A shape with modal mass (or modal A) is mass-normalised by it. A note says what was converted.
MeasuredModes modes_from_uff(std::string_view bytes, const std::string& file, const std::string& units,
                             std::vector<std::string>& notes);

/// One specimen from a table with a column "dof" and a column a mode, named by its frequency: "5.99 Hz", "0.00599 kHz",
/// or a number alone in the study's unit.
MeasuredModes modes_from_table(const CsvTable& table, const std::string& units);

/// Specimens from the variables of a MATLAB file: `frequencies` [specimen x mode], Hz, `shapes` [degree of freedom x
/// mode x specimen], `dofs`, a cell array of names, and, where known, `modal_masses` [specimen x mode]; nan: not
/// measured.
std::vector<MeasuredModes> modes_from_mat(const std::map<std::string, MatVariable>& variables, const std::string& file,
                                          const std::string& units);

/// A table whose columns are variables, one number a specimen each.
CsvTable table_from_mat(const std::map<std::string, MatVariable>& variables, const std::string& file);

}  // namespace mottle::study
