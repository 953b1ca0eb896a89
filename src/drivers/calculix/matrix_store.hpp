// Matrices and eigenvalues of solver runs in a folder, each under the digest of what it was made from.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>

#include "mottle/core/checksum.hpp"
#include "mottle/drivers/calculix/separable_fit.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

/// Nothing where the run is not kept or its file is damaged.
std::optional<MatrixRun> find_run(const std::filesystem::path& folder, const Digest& digest);

/// Keeps a run, and of older ones as many as fit into 2 GB. A folder that cannot be written only prevents the reuse.
void keep_run(const std::filesystem::path& folder, const Digest& digest, const MatrixRun& run);

/// The same of the eigenvalues that the solver itself found.
std::optional<Eigen::VectorXd> find_eigenvalues(const std::filesystem::path& folder, const Digest& digest);
void keep_eigenvalues(const std::filesystem::path& folder, const Digest& digest, const Eigen::VectorXd& values);

}  // namespace mottle::drivers
