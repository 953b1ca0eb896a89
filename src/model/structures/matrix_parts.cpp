// Binds parameters to the parts of a structure's matrices that they scale.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"
#include "mottle/model/structures/matrix_structure.hpp"

namespace mottle::model {
namespace {

/// One matrix of the system: K:skin, or K and M of what no parameter moves.
struct Piece {
  std::string target = {};  ///< empty: constant
  bool is_mass = false;
  const SymmetricMatrix* matrix = nullptr;
  double nominal = 1.0;
  bool states_nominal = false;
  int exponent = 1;
  int parameter = -1;  ///< none
};

std::vector<Piece> list_pieces(const MatrixSystem& system) {
  std::vector<Piece> pieces;
  const auto add = [&pieces](const std::optional<SymmetricMatrix>& matrix, Piece piece) {
    if (!matrix) return;
    piece.matrix = &*matrix;
    pieces.push_back(std::move(piece));
  };
  add(system.stiffness, {});
  add(system.mass, {.is_mass = true});
  std::set<std::string> names;
  for (const MatrixPart& part : system.parts) {
    const double nominal = part.nominal.value_or(1.0);
    const Subject subject{Subject::Kind::matrix_part, part.name};
    require_of(nominal > 0.0, subject, "nominal value {}, must be > 0", nominal);
    require_of(names.insert(part.name).second, subject, "is given twice");
    Piece piece{.target = fmt::format("K:{}", part.name),
                .nominal = nominal,
                .states_nominal = part.nominal.has_value(),
                .exponent = part.exponent};
    add(part.stiffness, piece);
    piece.target = fmt::format("M:{}", part.name);
    piece.is_mass = true;
    add(part.mass, piece);
  }
  return pieces;
}

void bind(std::vector<Piece>& pieces, const std::vector<ParameterTargets>& parameters) {
  std::vector<std::string> known;
  for (const Piece& piece : pieces) {
    if (!piece.target.empty()) known.push_back(piece.target);
  }
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const Subject subject = subject_parameter(parameters[p].parameter);
    require_of(!parameters[p].targets.empty(), subject, "it has no target, so it acts on nothing");
    for (const std::string& target : parameters[p].targets) {
      const auto found = std::find_if(pieces.begin(), pieces.end(),
                                      [&](const Piece& piece) { return !target.empty() && piece.target == target; });
      require_of(found != pieces.end(), subject, "it acts on nothing: {}",
                 unknown_name_message("matrix", target, known));
      require_of(found->parameter < 0, subject, "target '{}' is already tied to parameter '{}'", target,
                 found->parameter < 0 ? "" : parameters[static_cast<std::size_t>(found->parameter)].parameter);
      found->parameter = static_cast<int>(p);
    }
  }
}

/// Where each row of a matrix goes in the pencil; -1: left out.
struct Numbering {
  std::vector<std::string> names;
  Eigen::Index size = 0;
  std::vector<std::vector<int>> rows;  ///< by piece
};

/// The matrix that no parameter moves, or the part by its name: "wall" of "K:wall".
Subject subject_of(const Piece& piece) {
  if (!piece.target.empty()) return {Subject::Kind::matrix_part, piece.target.substr(2)};
  return {piece.is_mass ? Subject::Kind::mass : Subject::Kind::stiffness};
}

bool are_alike(const std::vector<Piece>& pieces) {
  const SymmetricMatrix& first = *pieces.front().matrix;
  return std::all_of(pieces.begin(), pieces.end(), [&](const Piece& piece) {
    return piece.matrix->lower.rows() == first.lower.rows() && piece.matrix->names == first.names;
  });
}

/// By position where all matrices have the same rows, by name otherwise.
Numbering number_rows(const std::vector<Piece>& pieces) {
  Numbering result;
  std::map<std::string, int> by_name;
  const bool by_position = are_alike(pieces);
  if (by_position) {
    result.names = pieces.front().matrix->names;
    result.size = pieces.front().matrix->lower.rows();
  }
  for (const Piece& piece : pieces) {
    std::vector<int>& rows = result.rows.emplace_back();
    const SymmetricMatrix& matrix = *piece.matrix;
    const Subject subject = subject_of(piece);
    require_of(by_position || !matrix.names.empty(), subject,
               "has {} rows without names, others have {}; matrices of different rows are put together by names: give "
               "those of the degrees of freedom, or name them in the files",
               matrix.lower.rows(), pieces.front().matrix->lower.rows());
    std::set<std::string> own;
    for (int row = 0; row < static_cast<int>(matrix.lower.rows()); ++row) {
      if (by_position) {
        rows.push_back(row);
        continue;
      }
      const std::string& name = matrix.names[static_cast<std::size_t>(row)];
      require_of(own.insert(name).second, subject,
                 "row '{}' is given twice, so the matrices, whose rows differ, cannot be put together by names", name);
      const auto [entry, is_new] = by_name.try_emplace(name, static_cast<int>(result.names.size()));
      if (is_new) result.names.push_back(name);
      rows.push_back(entry->second);
    }
  }
  if (!by_position) result.size = static_cast<Eigen::Index>(result.names.size());
  return result;
}

/// Removes rows that the solver fixed from all matrices; returns their number.
int leave_out_fixed_rows(const std::vector<Piece>& pieces, Numbering& numbering) {
  std::set<int> fixed_rows;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    for (const int row : pieces[k].matrix->fixed_rows)
      fixed_rows.insert(numbering.rows[k][static_cast<std::size_t>(row)]);
  }
  std::vector<int> moved;
  std::vector<std::string> names;
  for (int row = 0, next = 0; row < static_cast<int>(numbering.size); ++row) {
    const bool stays = !fixed_rows.contains(row);
    if (stays && !numbering.names.empty()) names.push_back(numbering.names[static_cast<std::size_t>(row)]);
    moved.push_back(stays ? next++ : -1);
  }
  for (std::vector<int>& rows : numbering.rows) {
    for (int& row : rows) row = moved[static_cast<std::size_t>(row)];
  }
  numbering.names = std::move(names);
  numbering.size -= static_cast<Eigen::Index>(fixed_rows.size());
  return static_cast<int>(fixed_rows.size());
}

SparseMatrix renumbered(const SparseMatrix& lower, const std::vector<int>& rows, Eigen::Index size, double factor) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(lower.nonZeros()));
  for (int j = 0; j < lower.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator entry(lower, j); entry; ++entry) {
      const int row = rows[static_cast<std::size_t>(entry.row())];
      const int column = rows[static_cast<std::size_t>(j)];
      if (row < 0 || column < 0) continue;
      entries.emplace_back(std::max(row, column), std::min(row, column), factor * entry.value());
    }
  }
  SparseMatrix result(size, size);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

/// A parameter must be positive where it scales a stiffness or mass, unless that is a difference of matrices.
PhysicalLimit limit_of(const std::vector<Piece>& pieces, int parameter) {
  constexpr double k_none = -std::numeric_limits<double>::infinity();
  for (const Piece& piece : pieces) {
    if (piece.parameter != parameter) continue;
    if (piece.exponent != 1 || piece.matrix->lower.diagonal().minCoeff() >= 0.0) return {};
  }
  return {.lower = k_none, .excludes_lower = true};
}

double reference_of(const std::vector<Piece>& pieces, int parameter, bool is_factor, double fallback) {
  if (is_factor) return 1.0;
  std::set<double> nominals;
  for (const Piece& piece : pieces) {
    if (piece.parameter == parameter) {
      nominals.insert(piece.states_nominal ? piece.nominal : std::numeric_limits<double>::infinity());
    }
  }
  return nominals.size() == 1 && std::isfinite(*nominals.begin()) ? *nominals.begin() : fallback;
}

}  // namespace

MatrixModel bind_parameters(const MatrixSystem& system, const std::vector<ParameterTargets>& parameters,
                            const Eigen::VectorXd& fallback) {
  std::vector<Piece> pieces = list_pieces(system);
  const auto masses = std::count_if(pieces.begin(), pieces.end(), [](const Piece& piece) { return piece.is_mass; });
  require_of(masses > 0, {Subject::Kind::model}, "there is no mass matrix; give one, or the mass of a part");
  require_of(masses < static_cast<std::ptrdiff_t>(pieces.size()), {Subject::Kind::model},
             "there is no stiffness matrix; give one, or the stiffness of a part");
  bind(pieces, parameters);
  Numbering numbering = number_rows(pieces);
  MatrixModel model;
  const int fixed_rows = leave_out_fixed_rows(pieces, numbering);
  if (fixed_rows > 0)
    model.notes.push_back(fmt::format("{} degrees of freedom that the solver constrained are left out", fixed_rows));
  std::vector<ScaledMatrix> stiffness;
  std::vector<ScaledMatrix> mass;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const Piece& piece = pieces[k];
    const bool is_scaled = piece.parameter >= 0;
    const bool is_factor = is_scaled && parameters[static_cast<std::size_t>(piece.parameter)].is_factor;
    const double factor = is_scaled && !is_factor ? std::pow(piece.nominal, -piece.exponent) : 1.0;
    std::vector<ParameterPower> coefficient;
    if (is_scaled) coefficient.push_back({piece.parameter, piece.exponent});
    (piece.is_mass ? mass : stiffness)
        .push_back(
            {std::move(coefficient), renumbered(piece.matrix->lower, numbering.rows[k], numbering.size, factor)});
  }
  model.pencil = make_pencil(stiffness, mass, std::move(numbering.names));
  model.reference = fallback;
  for (int p = 0; p < static_cast<int>(parameters.size()); ++p) {
    model.limits.push_back(limit_of(pieces, p));
    model.reference(p) = reference_of(pieces, p, parameters[static_cast<std::size_t>(p)].is_factor, fallback(p));
  }
  return model;
}

}  // namespace mottle::model
