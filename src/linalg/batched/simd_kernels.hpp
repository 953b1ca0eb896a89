// Interface between batch_eigen.cpp and the kernels that are compiled once per register width. Plain data only:
// an inline function here would be compiled with AVX-512 flags too and the linker might keep that copy.
#pragma once

namespace mottle::linalg {
enum class SimdLevel;
}

namespace mottle::linalg::simd_kernels {

/// How the mass is given to a kernel.
enum class MassKind {
  folded,           ///< constant; the stiffness terms are in standard form already
  folded_diagonal,  ///< the same, and the back-transformation is diagonal
  diagonal,         ///< depends on the sample; every term diagonal
  full,             ///< depends on the sample
};

/// A family and its coefficients. Packed matrices hold the lower triangle column by column.
struct Problem {
  int order = 0;
  int modes = 0;
  bool vectors = false;
  MassKind mass_kind = MassKind::folded;
  int stiffness_terms = 0;
  int mass_terms = 0;
  const double* stiffness = nullptr;               ///< [1 + terms][packed], the constant first
  const double* mass = nullptr;                    ///< [1 + terms][packed, or order if diagonal]; null if folded
  const double* back_transform = nullptr;          ///< folded: L^-T, [order x order] by columns; null otherwise
  const double* stiffness_coefficients = nullptr;  ///< [sample][term]
  const double* mass_coefficients = nullptr;
  long stiffness_stride = 0;
  long mass_stride = 0;
};

/// Where results go; valid = 0 for a sample whose modes the kernel cannot guarantee.
struct Output {
  double* values = nullptr;   ///< [sample][mode]
  double* vectors = nullptr;  ///< [sample][mode][dof] or null
  unsigned char* valid = nullptr;
};

/// Pencils near a nominal one, in whose modes they are written: there K - shift M = 1 and M = diag nominal_mass,
/// descending. Matrices are in tiles, each full, by rows: of K and M those of the lower triangle column by column, of
/// W'K_t and W'M_t all, row by row; the tiles of all terms at one position follow one another, the constant's first.
/// The order is padded to a multiple of k_tile with ones in K and zeros in M.
struct DavidsonProblem {
  int order = 0;      ///< with padding
  int rows = 0;       ///< without
  int block = 0;      ///< vectors; this and the next two are multiples of k_block_columns
  int kept = 0;       ///< Ritz vectors of the block, no fewer than the modes
  int corrected = 0;  ///< vectors that are corrected more than once, no fewer than `converged`
  int modes = 0;      ///< wanted
  int converged = 0;  ///< number of lowest modes whose residuals must be below the limit
  int stiffness_terms = 0;
  int mass_terms = 0;
  const double* stiffness = nullptr;               ///< [tile][1 + terms]
  const double* mass = nullptr;                    ///< the same; unused where the mass is constant
  const double* nominal_mass = nullptr;            ///< [order]
  const double* stiffness_coefficients = nullptr;  ///< [sample][term]
  const double* mass_coefficients = nullptr;
  long stiffness_stride = 0;
  long mass_stride = 0;
  const double* ratios = nullptr;       ///< [sample]: K - shift M >= ratio of the nominal one
  const double* mass_ratios = nullptr;  ///< [sample]: M <= mass_ratios times the nominal one
  double shift = 0.0;
  double smallest = 0.0;                     ///< errors of smaller eigenvalues are relative to this
  double limit = 0.0;                        ///< convergence criterion r'r <= limit ratio max(lambda, smallest) y'My
  int sketch_rows = 0;                       ///< a multiple of k_tile
  const double* stiffness_sketch = nullptr;  ///< [tile][1 + terms]
  const double* mass_sketch = nullptr;       ///< the same
  double* sketched_residuals = nullptr;      ///< out: W'(K - lambda M) y [sample][mode][sketch row]
};

/// A sparse symmetric matrix by its lower triangle, compressed columns.
struct SparseLower {
  int columns = 0;
  const int* starts = nullptr;
  const int* rows = nullptr;
  const double* values = nullptr;
  const int* row_indices = nullptr;  ///< [column]: its row in longer vectors, for the kernels that use them
};

/// Some rows of vectors in any strided layout: entry i of vector v is data[i * row_step + v * vector_step].
struct GatheredVectors {
  int vectors = 0;
  const double* data = nullptr;
  long row_step = 0;
  long vector_step = 0;
  int row_count = 0;
  const int* rows = nullptr;  ///< [row_count]; null: the first ones
};

/// A supernodal L as CHOLMOD keeps it: neighbouring columns of equal pattern are one dense block [row x column] by
/// columns, whose first rows are those of its diagonal. What lies above the diagonal is not read.
struct SupernodalLower {
  int supernodes = 0;
  const int* columns = nullptr;       ///< [supernode + 1]: the first column of each
  const int* row_starts = nullptr;    ///< [supernode + 1]: into rows
  const int* rows = nullptr;          ///< ascending in each supernode
  const int* value_starts = nullptr;  ///< [supernode + 1]: into values
  const double* values = nullptr;
};

/// Vectors side by side are padded to a multiple of this.
constexpr int k_vector_padding = 8;
constexpr int k_tile = 16;
constexpr int k_block_columns = 6;

/// Kernels of one register width; each solves samples [begin, end).
struct Kernels {
  void (*solve_small)(const Problem&, const Output&, long begin, long end);
  /// The workspace holds workspace_doubles(problem) and is aligned to 64 bytes.
  void (*solve_large)(const Problem&, const Output&, long begin, long end, double* workspace);
  long (*workspace_doubles)(const Problem&);
  /// Writes nothing for samples whose modes it cannot guarantee, `valid` included.
  void (*solve_davidson)(const DavidsonProblem&, const Output&, long begin, long end, double* workspace);
  long (*davidson_doubles)(const DavidsonProblem&);
  /// out += A in for `width` vectors, a multiple of k_vector_padding: both [column][vector].
  void (*add_symmetric_product)(const SparseLower&, int width, const double* in, double* out);
  /// The same from the matrix' own rows of longer vectors: in [row of those][vector]. out + rest is the sum as if it
  /// were found in twice the precision; both are added to.
  void (*add_local_product)(const SparseLower&, int width, const double* in, double* out, double* rest);
  /// And back to them, each vector with a factor: in and out [row of those][vector], scales [vector].
  void (*add_scaled_product)(const SparseLower&, const double* scales, int width, const double* in, double* out);
  /// out += left' right for `width` vectors, a multiple of k_vector_padding: right [row of left][vector], out
  /// [left vector][vector].
  void (*add_gathered_product)(const GatheredVectors& left, int width, const double* right, double* out);
  /// Solve L X = B and L' X = B in place for `width` right-hand sides, one or a multiple of `lanes`: x [row][side].
  void (*solve_lower)(const SupernodalLower&, int width, double* x);
  void (*solve_lower_transposed)(const SupernodalLower&, int width, double* x);
  int lanes;  ///< doubles in a register
};

/// The kernels of a register width, the widest where none is asked for. @throws InvalidInput  this processor lacks it
const Kernels& kernels_for(SimdLevel level = {});

/// Memory of one thread's kernel calls, aligned to 64 bytes; kept between calls because fresh pages cost as much as
/// small solves.
double* thread_workspace(long doubles);

/// Orders that the kernels take: small ones up to k_jacobi_limit, large ones up to k_order_limit.
constexpr int k_jacobi_limit = 8;
constexpr int k_order_limit = 400;

void jacobi_plain(const Problem&, const Output&, long begin, long end);
extern const Kernels k_plain;
#if defined(__x86_64__)
void jacobi_avx2(const Problem&, const Output&, long begin, long end);
void jacobi_avx512(const Problem&, const Output&, long begin, long end);
extern const Kernels k_avx2;
extern const Kernels k_avx512;
#endif

}  // namespace mottle::linalg::simd_kernels
