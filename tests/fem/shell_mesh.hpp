// Small shell structures for tests: a mesh over the unit square, its matrices, static solutions and frequencies.
#pragma once

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "mottle/fem/elements/shell.hpp"

namespace mottle::test {

using namespace fem;  // of which these are the tests

struct ShellMesh {
  std::vector<Eigen::Vector3d> nodes;
  std::vector<std::vector<int>> elements;

  /// Where `claim` holds, `components` ("123456") are fixed.
  void fix(const std::function<bool(const Eigen::Vector3d&)>& claim, const char* components) {
    is_fixed.resize(6 * nodes.size(), false);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (!claim(nodes[i])) continue;
      for (const char* c = components; *c != '\0'; ++c) is_fixed[6 * i + static_cast<std::size_t>(*c - '1')] = true;
    }
  }

  std::vector<bool> is_fixed;
};

/// Grid over the unit square, mapped to space; each cell a quadrilateral or two triangles.
inline ShellMesh grid(int columns, int rows, int node_count,
                      const std::function<Eigen::Vector3d(double, double)>& map) {
  ShellMesh mesh;
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) mesh.nodes.push_back(map(double(i) / columns, double(j) / rows));
  }
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const int a = j * (columns + 1) + i, b = a + 1, c = b + columns + 1, d = c - 1;
      if (node_count == 4) {
        mesh.elements.push_back({a, b, c, d});
      } else {
        mesh.elements.push_back({a, b, c});
        mesh.elements.push_back({a, c, d});
      }
    }
  }
  mesh.fix([](const Eigen::Vector3d&) { return false; }, "");
  return mesh;
}

/// MacNeal and Harder's patch: four inner nodes, five distorted cells.
inline ShellMesh patch(int node_count) {
  ShellMesh mesh;
  for (const auto& [x, y] : std::vector<std::array<double, 2>>{{0.0, 0.0},
                                                               {0.24, 0.0},
                                                               {0.24, 0.12},
                                                               {0.0, 0.12},
                                                               {0.04, 0.02},
                                                               {0.18, 0.03},
                                                               {0.16, 0.08},
                                                               {0.08, 0.08}}) {
    mesh.nodes.emplace_back(x, y, 0.0);
  }
  for (const std::vector<int>& cell :
       std::vector<std::vector<int>>{{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {4, 5, 6, 7}}) {
    if (node_count == 4) {
      mesh.elements.push_back(cell);
    } else {
      mesh.elements.push_back({cell[0], cell[1], cell[2]});
      mesh.elements.push_back({cell[0], cell[2], cell[3]});
    }
  }
  mesh.fix([](const Eigen::Vector3d& r) { return r.x() == 0.0 || r.x() == 0.24; }, "123456");
  return mesh;
}

/// PSHELL of one material, shear correction 5/6, K6ROT = 100.
struct ShellMaterial {
  double young = 1.0, poisson = 0.3, thickness = 0.01;
  double reference_thickness = 0.0;  ///< at which the shear flexibility is taken; 0: the thickness
  bool is_rigid_in_shear = false;

  double shear() const { return 0.5 * young / (1.0 + poisson); }
  double plate() const { return young * std::pow(thickness, 3) / (12.0 * (1.0 - poisson * poisson)); }
};

inline ShellInput shell_input(const ShellMesh& mesh, const std::vector<int>& element, const ShellMaterial& material) {
  const double t = material.reference_thickness > 0.0 ? material.reference_thickness : material.thickness;
  ShellInput input{.node_count = static_cast<int>(element.size()),
                   .poisson_membrane = material.poisson,
                   .poisson_bending = material.poisson,
                   .shear_flexibility = material.is_rigid_in_shear ? 0.0 : t * t / (5.0 * (1.0 - material.poisson))};
  for (std::size_t i = 0; i < element.size(); ++i)
    input.nodes.col(static_cast<int>(i)) = mesh.nodes[static_cast<std::size_t>(element[i])];
  return input;
}

inline ShellMatrix shell_matrix(const ShellInput& input, const ShellMaterial& material) {
  const ShellPieces pieces = shell_stiffness(input);
  const double t = material.thickness, et = material.young * t, gt = material.shear() * t;
  return et * pieces.membrane + et * t * t * pieces.bending + 5.0 / 6.0 * gt * pieces.shear +
         100.0 * gt * pieces.drilling;
}

using Sparse = Eigen::SparseMatrix<double>;

/// Sum of element matrices.
inline Sparse assembled(const ShellMesh& mesh, const std::function<ShellMatrix(const std::vector<int>&)>& matrix_of) {
  std::vector<Eigen::Triplet<double>> entries;
  for (const std::vector<int>& element : mesh.elements) {
    const ShellMatrix matrix = matrix_of(element);
    const int size = 6 * static_cast<int>(element.size());
    const auto global = [&](int i) { return 6 * element[static_cast<std::size_t>(i / 6)] + i % 6; };
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j < size; ++j) {
        if (matrix(i, j) != 0.0) entries.emplace_back(global(i), global(j), matrix(i, j));
      }
    }
  }
  const int size = 6 * static_cast<int>(mesh.nodes.size());
  Sparse sum(size, size);
  sum.setFromTriplets(entries.begin(), entries.end());
  return sum;
}

inline Sparse stiffness(const ShellMesh& mesh, const ShellMaterial& material) {
  return assembled(mesh, [&](const auto& e) { return shell_matrix(shell_input(mesh, e, material), material); });
}

/// At unit mass per area.
inline Sparse mass(const ShellMesh& mesh, MassKind kind) {
  return assembled(mesh, [&](const auto& e) { return shell_mass(shell_input(mesh, e, {}), kind); });
}

/// Selects the free degrees of freedom.
inline Sparse degrees_of_freedom(const ShellMesh& mesh) {
  std::vector<Eigen::Triplet<double>> entries;
  int free = 0;
  for (std::size_t i = 0; i < mesh.is_fixed.size(); ++i) {
    if (!mesh.is_fixed[i]) entries.emplace_back(static_cast<int>(i), free++, 1.0);
  }
  Sparse select(static_cast<int>(mesh.is_fixed.size()), free);
  select.setFromTriplets(entries.begin(), entries.end());
  return select;
}

/// Displacements under loads, of all degrees of freedom.
inline Eigen::VectorXd solve(const ShellMesh& mesh, const Sparse& K, const Eigen::VectorXd& loads) {
  const Sparse select = degrees_of_freedom(mesh);
  const Eigen::SimplicialLDLT<Sparse> factor(Sparse(select.transpose() * K * select));
  return select * factor.solve(select.transpose() * loads);
}

/// Displacements under a uniform load per area in a direction.
inline Eigen::VectorXd solve_uniform(const ShellMesh& mesh, const ShellMaterial& material, int component, double load) {
  Eigen::VectorXd field = Eigen::VectorXd::Zero(6 * static_cast<int>(mesh.nodes.size()));
  for (int i = component; i < field.size(); i += 6) field(i) = load;
  return solve(mesh, stiffness(mesh, material), mass(mesh, MassKind::consistent) * field);
}

/// Lowest circular frequencies at unit mass per area, by subspace iteration (no rigid motions allowed).
/// @param stiffness  of all degrees of freedom
inline Eigen::VectorXd frequencies(const ShellMesh& mesh, const Sparse& stiffness, MassKind kind, int count) {
  const Sparse select = degrees_of_freedom(mesh);
  const Sparse K = select.transpose() * stiffness * select;
  const Sparse M = select.transpose() * mass(mesh, kind) * select;
  const Eigen::SimplicialLDLT<Sparse> factor(K);
  const int width = 2 * count + 4;
  Eigen::MatrixXd block(K.rows(), width);
  for (int j = 0; j < width; ++j) {
    for (int i = 0; i < block.rows(); ++i) block(i, j) = std::sin(1.0 + 0.7 * i + 1.3 * j * i);
  }
  Eigen::VectorXd values;
  for (int iteration = 0; iteration < 12; ++iteration) {
    block = factor.solve(M * block);
    const Eigen::MatrixXd stiff = block.transpose() * (K * block), heavy = block.transpose() * (M * block);
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> small(heavy, stiff);
    block = block * small.eigenvectors().rowwise().reverse();
    values = small.eigenvalues().reverse().head(count).array().inverse().sqrt();
  }
  return values;
}

inline Eigen::VectorXd frequencies(const ShellMesh& mesh, const ShellMaterial& material, MassKind kind, int count) {
  return frequencies(mesh, stiffness(mesh, material), kind, count);
}

}  // namespace mottle::test
