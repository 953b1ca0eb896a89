#include "mottle/linalg/reduced/reduced_model_file.hpp"

#include <algorithm>
#include <deque>
#include <fstream>
#include <string>
#include <string_view>
#include <type_traits>

#include "linalg/reduced/reduced_model_parts.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"

namespace mottle::linalg {
namespace {

constexpr std::string_view k_magic("mottle basis 3\n\0", 16);
constexpr std::uint64_t k_byte_order = 0x0102030405060708;

/// In front of the numbers.
struct Head {
  std::array<char, 16> magic = {};
  std::uint64_t byte_order = k_byte_order;
  Digest fingerprint = {};
  std::uint64_t size = 0;  ///< bytes behind the head
  Digest checksum = {};    ///< of them
};
static_assert(std::has_unique_object_representations_v<Head>);

/// Lists what is to be written; large arrays are only pointed at.
class Writer {
 public:
  template <typename Number>
  requires std::is_arithmetic_v<Number>
  void operator()(const Number& value) {
    add(small_.emplace_back(reinterpret_cast<const char*>(&value), sizeof(value)));
  }
  template <int columns>
  void operator()(const Eigen::Matrix<double, Eigen::Dynamic, columns>& matrix) {
    (*this)(std::int64_t{matrix.rows()});
    (*this)(std::int64_t{matrix.cols()});
    add({reinterpret_cast<const char*>(matrix.data()), static_cast<std::size_t>(matrix.size()) * sizeof(double)});
  }
  template <typename Item>
  void operator()(const std::vector<Item>& list) {
    (*this)(static_cast<std::int64_t>(list.size()));
    for (const Item& item : list) (*this)(item);
  }
  void operator()(const ReferencePencil& reference) {
    const auto& [stiffness, mass, complete_to, modes] = reference;
    (*this)(stiffness);
    (*this)(mass);
    (*this)(complete_to);
    (*this)(modes);
  }

  /// Everything behind a head that describes it.
  std::vector<std::string_view> pieces(Head& head) const {
    Checksum checksum;
    for (const std::string_view piece : pieces_) {
      checksum.add(piece);
      head.size += piece.size();
    }
    head.checksum = checksum.digest();
    std::vector<std::string_view> result{{reinterpret_cast<const char*>(&head), sizeof(head)}};
    result.insert(result.end(), pieces_.begin(), pieces_.end());
    return result;
  }

 private:
  void add(std::string_view piece) { pieces_.push_back(piece); }

  std::deque<std::string> small_;  // a deque's items stay where they are
  std::vector<std::string_view> pieces_;
};

/// Reads what a Writer wrote; allocates no more than the file has bytes.
class Reader {
 public:
  Reader(std::ifstream& stream, std::uint64_t size) : stream_(stream), left_(size) {}

  template <typename Number>
  requires std::is_arithmetic_v<Number>
  void operator()(Number& value) { copy(&value, sizeof(value)); }
  void operator()(bool& value) {
    std::uint8_t byte = 0;
    copy(&byte, sizeof(byte));
    require(byte <= 1, "its parts do not fit together");  // a bool holds nothing else
    value = byte == 1;
  }
  template <int columns>
  void operator()(Eigen::Matrix<double, Eigen::Dynamic, columns>& matrix) {
    const std::uint64_t rows = count(1);
    const std::uint64_t width = rows == 0 ? size() : count(1);  // nothing may follow what is empty
    const std::uint64_t max_entries = left_ / sizeof(double);
    require(width == 0 || rows <= max_entries / width, "its parts do not fit together");
    require(columns == Eigen::Dynamic || width == 1, "its parts do not fit together");
    matrix.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(width));
    copy(matrix.data(), rows * width * sizeof(double));
  }
  template <typename Item>
  void operator()(std::vector<Item>& list) {
    list.resize(count(sizeof(double)));  // no item takes fewer bytes
    for (Item& item : list) (*this)(item);
  }
  void operator()(ReferencePencil& reference) {
    auto& [stiffness, mass, complete_to, modes] = reference;
    (*this)(stiffness);
    (*this)(mass);
    (*this)(complete_to);
    (*this)(modes);
  }

  std::uint64_t left() const { return left_; }
  Digest digest() const { return checksum_.digest(); }

 private:
  std::uint64_t size() {
    std::int64_t value = 0;
    (*this)(value);
    require(value >= 0, "its parts do not fit together");
    return static_cast<std::uint64_t>(value);
  }
  std::uint64_t count(std::uint64_t min_bytes) {
    const std::uint64_t value = size();
    require(value <= left_ / min_bytes, "its parts do not fit together");
    return value;
  }
  void copy(void* destination, std::uint64_t size) {
    require(size <= left_, "it ends too early");
    stream_.read(static_cast<char*>(destination), static_cast<std::streamsize>(size));
    require(stream_.good(), "it ends too early");
    checksum_.add(destination, size);
    left_ -= size;
  }

  std::ifstream& stream_;
  std::uint64_t left_;
  Checksum checksum_;
};

/// All that a file keeps, in its order. A new member of these structures does not compile here until it is placed.
template <typename Visitor, typename Facts, typename Parts>
void visit(Visitor& visitor, Facts& nominal, Parts& parts) {
  auto& [stiffness_bounds, mass_bounds, mass_fraction, exact_seconds, shift, highest_mode, resolution] = nominal;
  visitor(stiffness_bounds);
  visitor(mass_bounds);
  visitor(mass_fraction);
  visitor(exact_seconds);
  visitor(shift);
  visitor(highest_mode);
  visitor(resolution);
  auto& [full, options, basis, pending, stiffness, mass, reference_pencils, reaches_tolerance, reference_modes,
         stiffness_sketch, mass_sketch, prepared, leading_directions, leading_levels, leading] = parts;
  (void)full;      // made from the inputs
  (void)options;   // an input
  (void)pending;   // nothing once the basis is trained
  (void)prepared;  // made from the others, as `leading` is
  (void)leading;
  visitor(basis);
  visitor(stiffness);
  visitor(mass);
  visitor(reference_pencils);
  visitor(reaches_tolerance);
  visitor(reference_modes);
  visitor(stiffness_sketch);
  visitor(mass_sketch);
  visitor(leading_directions);
  visitor(leading_levels);
}

/// Whether a model of these inputs can have such parts.
template <typename Parts>
bool fit(const NominalFacts& facts, const Parts& parts, const ReducedModelInputs& inputs) {
  const Eigen::Index vectors = parts.basis.cols();
  const std::size_t stiffness = inputs.terms.stiffness.size() + 1;
  const std::size_t mass = inputs.terms.mass.size() + 1;
  const auto are = [](const std::vector<Eigen::MatrixXd>& terms, std::size_t count, Eigen::Index rows,
                      Eigen::Index columns) {
    return terms.size() == count && std::ranges::all_of(terms, [&](const Eigen::MatrixXd& term) {
             return term.rows() == rows && term.cols() == columns;
           });
  };
  const auto is_table = [](const Eigen::MatrixXd& bounds, std::size_t terms) {
    return bounds.rows() == static_cast<Eigen::Index>(terms) && bounds.cols() == 2;
  };
  const auto is_reference = [&](const ReferencePencil& reference) {
    return reference.stiffness.size() == static_cast<Eigen::Index>(stiffness) &&
           reference.mass.size() == static_cast<Eigen::Index>(mass);
  };
  std::int64_t reference_modes = 0;
  for (const ReferencePencil& reference : parts.reference_pencils) reference_modes += reference.modes;
  return vectors > 0 && parts.basis.rows() == inputs.stiffness.rows() && is_table(facts.stiffness_bounds, stiffness) &&
         is_table(facts.mass_bounds, mass) && are(parts.stiffness, stiffness, vectors, vectors) &&
         are(parts.mass, mass, vectors, vectors) && are(parts.stiffness_sketch, stiffness, k_sketch_rows, vectors) &&
         are(parts.mass_sketch, mass, k_sketch_rows, vectors) && !parts.reference_pencils.empty() &&
         std::ranges::all_of(parts.reference_pencils, is_reference) && parts.reference_modes.rows() == vectors &&
         parts.reference_modes.cols() == reference_modes &&
         (parts.leading_directions.size() == 0 || parts.leading_directions.rows() == vectors) &&
         parts.leading_levels.size() ==
             (parts.leading_directions.size() > 0 ? static_cast<Eigen::Index>(parts.reference_pencils.size()) : 0);
}

void check(const Head& head, const Digest& fingerprint, std::uint64_t file_size) {
  require(std::string_view(head.magic.data(), head.magic.size()) == k_magic, "it is no reduced basis of this format");
  require(head.byte_order == k_byte_order, "it comes from a machine with another order of bytes");
  require(head.fingerprint == fingerprint, "it belongs to another model, prior or version");
  require(file_size - sizeof(Head) == head.size, "it has {} bytes, its head says {}", file_size,
          head.size + sizeof(Head));
}

}  // namespace

ReducedModel::ReducedModel(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

ReducedModelFile::Contents ReducedModelFile::read(const ReducedModelInputs& inputs) const {
  std::error_code error;
  require(std::filesystem::is_regular_file(path_, error), "it is no file");  // a pipe would be waited for
  std::ifstream stream(path_, std::ios::binary);
  require(stream.good(), "it cannot be opened");
  const std::uint64_t size = std::filesystem::file_size(path_, error);
  require(!error && size >= sizeof(Head), "it ends too early");
  Head head;
  stream.read(reinterpret_cast<char*>(&head), sizeof(head));
  require(stream.good(), "it cannot be read");
  check(head, fingerprint_, size);

  Contents contents;
  NominalFacts facts;
  auto parts = std::make_unique<ReducedModel::Parts>();
  Reader reader(stream, head.size);
  reader(contents.training_seconds);
  visit(reader, facts, *parts);
  require(reader.left() == 0 && fit(facts, *parts, inputs), "its parts do not fit together");
  require(reader.digest() == head.checksum, "its checksum is wrong");
  parts->options = inputs.options;
  parts->full =
      std::make_shared<FullPencils>(inputs.terms, inputs.nominal, inputs.stiffness, inputs.mass, std::move(facts));
  if (const Eigen::MatrixXd directions = parts->leading_directions; directions.size() > 0) {
    parts->make_leading(directions, Eigen::VectorXd(parts->leading_levels));
  }
  contents.model.reset(new ReducedModel(std::move(parts)));
  return contents;
}

void ReducedModelFile::write(const ReducedModel& model, double training_seconds) const {
  Writer writer;
  writer(training_seconds);
  const NominalFacts& facts = *model.parts_->full;
  visit(writer, facts, *model.parts_);
  Head head;
  k_magic.copy(head.magic.data(), head.magic.size());
  head.fingerprint = fingerprint_;
  write_file_atomically(path_, writer.pieces(head));
}

}  // namespace mottle::linalg
