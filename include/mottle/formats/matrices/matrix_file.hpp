// Stiffness and mass matrices as solvers write them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/linalg/sparse/symmetric_factor.hpp"

namespace mottle::formats {

/// A symmetric matrix with the names of its rows.
struct SymmetricMatrix {
  SparseMatrix lower;                   ///< lower triangle, compressed
  std::vector<std::string> names = {};  ///< "101:+Z", "101:+RX", "7" of a scalar point; empty where the file has none.
                                        ///< CalculiX repeats those of expanded shells and beams, one a layer
  std::vector<int> fixed_rows = {};     ///< rows that the solver fixed by a penalty on the diagonal, ascending
};

/// Extensions of files beside a matrix that hold the names of its rows.
inline constexpr const char* k_names_beside_matrices[] = {".dof", ".mapping"};

/// Reads one matrix. By content and, where that leaves it open, by extension:
///
///   Matrix Market            coordinate or array, real or integer, general or symmetric
///   CalculiX .sti, .mas      names from the .dof file beside it
///   Abaqus *MATRIX GENERATE  coordinate and matrix-input text; a diagonal >= 1e36 is held
///   Nastran DMIG             punch, small and large field, symmetric (6) or square (1)
///   Nastran OUTPUT4          text and binary of either byte order, dense, sparse and BIGMAT
///   Harwell-Boeing           assembled real (ANSYS HBMAT); names from the .mapping file beside it
///   HDF5                     square dataset, or group with data, indices, indptr, or with data, row, col
///
/// One triangle may be stored, or both if they agree to 1e-9 of the diagonal. Rows and columns of Nastran's g-set
/// matrices are sorted by grid point and component.
///
/// @param location  path, and behind a '#' the matrix's name in a file of several ("model.op4#KAA")
/// @throws InvalidInput  a file that is missing, a name that the file does not have (with those it has)
/// @throws FormatError   (file, line where there are lines) what cannot be read, is complex, not square or not
/// symmetric
SymmetricMatrix read_symmetric_matrix(const std::string& location);

/// The file of `location`: what stands before a '#'.
std::filesystem::path file_of_matrix(const std::string& location);

/// Names of rows, one a line: CalculiX's .dof ("101.3") or "101:+Z", or a line of ANSYS's .mapping ("7 101 UZ").
///
/// @throws FormatError  a line that is none of these
std::vector<std::string> read_row_names(const std::filesystem::path& file);
std::vector<std::string> parse_row_names(std::string_view bytes, const std::string& file);

/// The same from memory, without the names of a file beside it.
///
/// @param name  of the matrix wanted; empty: the only one
SymmetricMatrix parse_symmetric_matrix(std::string_view bytes, const std::string& file, const std::string& name);

/// A Matrix Market file: coordinate, real, symmetric, with the shortest digits that read back exactly.
///
/// @param lower  lower triangle, compressed
std::string matrix_market_text(const SparseMatrix& lower);

/// One matrix of a file of Nastran's OUTPUT4: binary, little-endian, double precision, strings; with BIGMAT headers
/// beyond 65535 rows. A file of several is one after the other.
///
/// @param lower  lower triangle, compressed; both triangles are written, as Nastran does
/// @throws InvalidInput  a name that is none of Nastran's
std::string output4_bytes(const SparseMatrix& lower, const std::string& name);

}  // namespace mottle::formats
