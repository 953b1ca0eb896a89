#include "study/tests/pair_tests.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "mottle/core/subject.hpp"
#include "mottle/dynamics/modes/mac.hpp"
#include "study/input/first_few.hpp"

namespace mottle::study {
namespace {

std::string specimen_text(const std::vector<int>& numbers, Eigen::Index specimen) {
  return fmt::format("specimen {}",
                     numbers.empty() ? static_cast<int>(specimen) + 1 : numbers[static_cast<std::size_t>(specimen)]);
}

/// Column of the first component of a mode of `selection`, counted from 0.
Eigen::Index first_of_shape(const OutputSelection& selection, Eigen::Index mode, Eigen::Index points) {
  return static_cast<Eigen::Index>(selection.frequencies.size()) + mode * points;
}

/// Cosine of the measured components of a shape with those of the reference; 0 of a zero shape, nan of less than two.
double measured_cosine(const Eigen::VectorXd& shape, const Eigen::VectorXd& reference) {
  std::vector<Eigen::Index> rows;  // measured
  for (Eigen::Index d = 0; d < shape.size(); ++d) {
    if (!std::isnan(shape(d))) rows.push_back(d);
  }
  if (rows.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  return shape_cosines(reference(rows), shape(rows))(0, 0);
}

/// Columns of one quantity, by the number of the mode.
using ColumnsByMode = std::map<int, Eigen::Index>;

/// Those that have another place than frequencies and shapes: damping ratios, eigenvalues, and the ratios of each pair
/// of degrees of freedom.
///
/// @param first  column behind the shapes
std::vector<ColumnsByMode> other_columns(const OutputSelection& selection, Eigen::Index first) {
  std::vector<ColumnsByMode> columns(2);
  for (const int mode : selection.damping) columns[0][mode] = first++;
  for (const StaticLoad& load : selection.static_loads)
    first += static_cast<Eigen::Index>(load.degrees_of_freedom.size());
  for (const int mode : selection.eigenvalues) columns[1][mode] = first++;
  std::map<std::pair<std::string, std::string>, ColumnsByMode> ratios;
  for (const ShapeRatio& ratio : selection.shape_ratios) {
    ratios[{ratio.numerator, ratio.denominator}][ratio.mode] = first++;
  }
  for (auto& [pair, own] : ratios) columns.push_back(std::move(own));
  return columns;
}

/// A shape that is unlike the model's.
struct UnlikeShape {
  Eigen::VectorXd shape, reference;
};

/// Where the other sign of one degree of freedom would make the shapes alike: its index; else -1.
Eigen::Index reversed_component(const std::vector<UnlikeShape>& unlike) {
  constexpr double k_alike = 0.8;
  const Eigen::Index points = unlike.front().shape.size();
  Eigen::VectorXd mac = Eigen::VectorXd::Zero(points);
  for (const UnlikeShape& one : unlike) {
    for (Eigen::Index d = 0; d < points; ++d) {
      Eigen::VectorXd turned = one.shape;
      turned(d) = -turned(d);
      mac(d) += std::pow(measured_cosine(turned, one.reference), 2) / static_cast<double>(unlike.size());
    }
  }
  Eigen::Index best = 0;
  return mac.maxCoeff(&best) >= k_alike ? best : -1;
}

}  // namespace

std::vector<std::string> pair_tests(Eigen::MatrixXd& values, const OutputSelection& selection,
                                    const Eigen::Ref<const Eigen::MatrixXd>& reference,
                                    const std::vector<int>& numbers) {
  const std::vector<int>& modes = selection.shape_modes;
  const Subject pairing{Subject::Kind::pairing};
  require_of(!modes.empty(), pairing,
             "it needs measured shapes; name them in outputs.shapes, or give pairing = \"order\"");
  require_of(selection.frequencies.empty() || selection.frequencies == modes, pairing,
             "outputs.frequencies and outputs.shapes.modes must name the same modes in the same order");
  const auto count = static_cast<Eigen::Index>(modes.size());
  const Eigen::Index points = reference.rows();
  const auto first_shape = static_cast<Eigen::Index>(selection.frequencies.size());
  const double not_measured = std::numeric_limits<double>::quiet_NaN();
  const std::vector<ColumnsByMode> others = other_columns(selection, first_shape + count * points);
  std::vector<std::string> moved;
  std::vector<std::string> doubtful;
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    const Eigen::RowVectorXd row = values.row(s);
    Eigen::MatrixXd shapes = row.segment(first_shape, count * points).reshaped(points, count);
    for (Eigen::Index t = 0; t < count; ++t) {
      if (!shapes.col(t).allFinite()) shapes.col(t).setZero();
    }
    const Eigen::MatrixXd cosines = shape_cosines(reference, shapes);
    const std::vector<int> test_of = optimal_assignment(cosines.cwiseAbs2());
    for (Eigen::Index m = 0; m < count; ++m) {
      const Eigen::Index t = test_of[static_cast<std::size_t>(m)];
      const double mac = cosines(m, t) * cosines(m, t);
      const bool is_paired = mac >= selection.minimum_mac && mac > 0.0;
      const double sign = cosines(m, t) < 0.0 ? -1.0 : 1.0;
      const int number = modes[static_cast<std::size_t>(m)];
      if (first_shape > 0) values(s, m) = is_paired ? row(t) : not_measured;
      for (Eigen::Index d = 0; d < points; ++d) {
        values(s, first_shape + m * points + d) = is_paired ? sign * shapes(d, t) : not_measured;
      }
      const int label = modes[static_cast<std::size_t>(t)];
      for (const ColumnsByMode& columns : others) {
        if (!columns.contains(number)) continue;
        values(s, columns.at(number)) = is_paired && columns.contains(label) ? row(columns.at(label)) : not_measured;
      }
      if (is_paired && t != m) {
        moved.push_back(
            fmt::format("{} mode {} is the model's {} (MAC {:.2f})", specimen_text(numbers, s), label, number, mac));
      } else if (!is_paired && !shapes.col(t).isZero(0.0)) {
        doubtful.push_back(
            fmt::format("{} mode {} (best MAC with mode {}: {:.2f})", specimen_text(numbers, s), label, number, mac));
      }
    }
  }
  std::vector<std::string> notes;
  if (!moved.empty())
    notes.push_back(fmt::format("Paired by shape, {} modes renumbered: {}.", moved.size(), first_few(moved)));
  if (!doubtful.empty()) {
    notes.push_back(fmt::format("Modes that fit none of the model's and are left out: {}.", first_few(doubtful)));
  }
  return notes;
}

std::string turn_shapes(Eigen::MatrixXd& values, const OutputSelection& selection,
                        const Eigen::Ref<const Eigen::MatrixXd>& reference, const std::vector<int>& numbers) {
  const Eigen::Index points = reference.rows();
  const double limit = -std::sqrt(selection.minimum_mac);
  std::vector<std::string> turned;
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    for (Eigen::Index m = 0; m < reference.cols(); ++m) {
      auto shape = values.row(s).segment(first_of_shape(selection, m, points), points);
      const double cosine = measured_cosine(shape.transpose(), reference.col(m));
      if (!(cosine <= limit) || cosine == 0.0) continue;
      shape = -shape.eval();
      turned.push_back(
          fmt::format("{} mode {}", specimen_text(numbers, s), selection.shape_modes[static_cast<std::size_t>(m)]));
    }
  }
  if (turned.empty()) return {};
  return fmt::format("Shapes that were upside down against the model's and are turned, {}: {}.", turned.size(),
                     first_few(turned));
}

std::string unlike_shapes(const Eigen::MatrixXd& values, const OutputSelection& selection,
                          const Eigen::Ref<const Eigen::MatrixXd>& reference, const std::vector<int>& numbers) {
  const Eigen::Index points = reference.rows();
  std::vector<UnlikeShape> unlike;
  std::vector<std::string> named;
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    for (Eigen::Index m = 0; m < reference.cols(); ++m) {
      const Eigen::VectorXd shape = values.row(s).segment(first_of_shape(selection, m, points), points).transpose();
      const double mac = std::pow(measured_cosine(shape, reference.col(m)), 2);
      if (!(mac < selection.minimum_mac)) continue;
      unlike.push_back({shape, reference.col(m)});
      named.push_back(fmt::format("{} mode {} (MAC {:.2f})", specimen_text(numbers, s),
                                  selection.shape_modes[static_cast<std::size_t>(m)], mac));
    }
  }
  if (unlike.empty()) return {};
  std::string sentence =
      fmt::format("Shapes that are unlike the model's and are used as they stand: {}.", first_few(named));
  if (const Eigen::Index d = reversed_component(unlike); d >= 0) {
    return sentence + fmt::format(
                          " With the other sign of {} they are alike: is that sensor upside down, or its sign "
                          "mistyped?",
                          selection.shape_degrees_of_freedom[static_cast<std::size_t>(d)]);
  }
  return sentence + " If the tests number modes otherwise than the model, test.pairing = \"mac\" pairs them by shape.";
}

}  // namespace mottle::study
