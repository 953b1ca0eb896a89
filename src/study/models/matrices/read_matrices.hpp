// A model from matrices in files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/structures/matrix_structure.hpp"

namespace mottle::study {

/// Matrices of a part of the structure, by location ("K1.mtx", "model.op4#K1"; resolved), and how parameters scale
/// it.
struct MatrixPartFiles {
  std::string name = {};
  std::string stiffness = {};  ///< empty: none
  std::string mass = {};
  std::optional<double> nominal = {};
  int exponent = 1;
};

/// All matrices of a model, by location.
struct MatrixFiles {
  MatrixPartFiles constant_part = {};  ///< what no parameter moves
  std::vector<MatrixPartFiles> parts = {};
  std::filesystem::path row_names = {};  ///< the degrees of freedom, where not in the files
};

/// @param files  those that were read are added
/// @throws InvalidInput, FormatError  as read_symmetric_matrix and bind_parameters
MatrixModel read_matrices(const MatrixFiles& source, const std::vector<ParameterTargets>& targets,
                          const Eigen::VectorXd& prior_mean, std::vector<std::string>& files);

}  // namespace mottle::study
