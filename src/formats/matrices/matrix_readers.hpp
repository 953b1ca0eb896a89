// One function a matrix format; matrix_file chooses among them.
#pragma once

#include "formats/matrices/matrix_text.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats {

SymmetricMatrix parse_matrix_market(std::string_view bytes, const std::string& file);
/// "row column value" a line: CalculiX, and Abaqus's coordinate format.
SymmetricMatrix parse_triples(std::string_view bytes, const std::string& file);
/// "node, component, node, component, value" a line.
SymmetricMatrix parse_abaqus_matrix(std::string_view bytes, const std::string& file);
SymmetricMatrix parse_dmig(std::string_view bytes, const std::string& file, const std::string& name);
SymmetricMatrix parse_output4(std::string_view bytes, const std::string& file, const std::string& name);
SymmetricMatrix parse_harwell_boeing(std::string_view bytes, const std::string& file);
SymmetricMatrix parse_hdf5_matrix(std::string_view bytes, const std::string& file, const std::string& name);

/// Rows whose diagonal is Abaqus's penalty, in ascending order.
std::vector<int> rows_with_penalty(const SparseMatrix& lower);

/// Throws InvalidInput: the file has no matrix `name`, or several and none is named.
std::size_t choose_matrix(const std::string& file, const std::string& name, const std::vector<std::string>& known);

}  // namespace mottle::formats
