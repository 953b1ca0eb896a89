// A trained reduced model in a file, with a fingerprint of everything that training depends on.
#pragma once

#include <filesystem>
#include <memory>

#include "mottle/core/checksum.hpp"
#include "mottle/linalg/reduced/reduced_model.hpp"

namespace mottle::linalg {

/// Everything that a trained model is made from, by reference.
struct ReducedModelInputs {
  const PencilTerms& terms;
  const TermCoefficients& nominal;
  const SparseMatrix& stiffness;  ///< at the nominal sample
  const SparseMatrix& mass;
  ReducedModelOptions options;
  const TermCoefficients& training;  ///< samples
};

/// Digest of every bit of the inputs and of everything else that the bits of a result depend on: Mottle's version,
/// sources and compiler, the BLAS and CHOLMOD in use and their kernels, the width of the registers. If digests are
/// equal, training gives equal bits.
Digest fingerprint(const ReducedModelInputs& inputs);

/// Keeps trained models in files: magic, byte order, fingerprint, checksum, then numbers as they lie in memory.
class ReducedModelFile {
 public:
  ReducedModelFile(std::filesystem::path path, const Digest& fingerprint)
      : path_(std::move(path)), fingerprint_(fingerprint) {}

  struct Contents {
    std::unique_ptr<ReducedModel> model;
    double training_seconds = 0.0;  ///< processor time that the model took when it was made
  };

  /// The model with the bits that it was written with: its solve() gives the same numbers. The factor of the nominal
  /// stiffness is made when train() asks for it.
  ///
  /// @throws InvalidInput  the file is not there, cannot be read, belongs to another fingerprint, or is not whole
  Contents read(const ReducedModelInputs& inputs) const;

  /// Writes atomically: to a name of this process's own, flushed and renamed, so that concurrent writers do no harm.
  ///
  /// @throws InvalidInput, SystemFailure  the folder cannot be written; full disk
  void write(const ReducedModel& model, double training_seconds) const;

 private:
  std::filesystem::path path_;
  Digest fingerprint_;
};

}  // namespace mottle::linalg
