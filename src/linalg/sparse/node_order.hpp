// Nested dissection of the nodes of a structure, which are found from the matrix's pattern.
#pragma once

#include <vector>

#include "mottle/linalg/sparse/symmetric_factor.hpp"

namespace mottle::linalg {

/// Number of the block that each row belongs to [row], ascending from 0: successive rows whose patterns are nearly the
/// first one's. In a matrix of a structure they are the equations of a node, whose patterns would be the same but for
/// entries that happen to be zero and are left out.
///
///   (rows that are neighbours of both) > 5/8 (rows that are neighbours of either)
///
/// The equations of two neighbouring nodes of a regular mesh have half of their neighbours in common at most.
///
/// @param lower  lower triangle, compressed
std::vector<int> blocks_of_like_rows(const SparseMatrix& lower);

/// Order of elimination [place] -> row by nested dissection (METIS) of the blocks in place of the rows, as many times
/// faster as a node has equations; no worse, since a node's equations are best eliminated together. Empty where METIS
/// itself finds as much: it puts rows of exactly one pattern together.
///
/// @param lower  lower triangle, compressed
/// Source: [Ashcraft1995].
std::vector<int> order_by_nodes(const SparseMatrix& lower);

}  // namespace mottle::linalg
