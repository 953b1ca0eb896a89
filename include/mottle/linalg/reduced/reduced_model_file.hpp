// A trained reduced model on disk, and how to know whether it is the one that training would make.
#pragma once

#include <filesystem>
#include <memory>

#include "mottle/core/checksum.hpp"
#include "mottle/linalg/reduced/reduced_model.hpp"

namespace mottle::linalg {

/// All that a trained model is made from. Refers to what it is made of.
struct ReducedModelInputs {
  const PencilTerms& terms;
  const TermCoefficients& nominal;
  const SparseMatrix& stiffness;  ///< at the nominal sample
  const SparseMatrix& mass;
  ReducedModelOptions options;
  const TermCoefficients& training;  ///< samples
};

/// Of every input, bit by bit, and of what else decides the last bit of a result: Mottle's version, sources and
/// compiler, the BLAS and CHOLMOD in use and their kernels, the width of the registers. Equal digests: training gives
/// equal bits.
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

  /// Under a name of this process's own, flushed and renamed: whole or not at all, whoever else writes there.
  ///
  /// @throws InvalidInput, SystemFailure  the place cannot be written; full disk
  void write(const ReducedModel& model, double training_seconds) const;

 private:
  std::filesystem::path path_;
  Digest fingerprint_;
};

}  // namespace mottle::linalg
