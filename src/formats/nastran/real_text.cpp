// Numbers in narrow fields.
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <tuple>

#include "formats/nastran/fields.hpp"
#include "mottle/formats/nastran/rewrite.hpp"

namespace mottle::formats {
namespace {

/// Keeps the best text so far: the nearest number, of equals one without exponent, of those the shortest.
class BestText {
 public:
  BestText(double value, int width) : value_(value), width_(static_cast<std::size_t>(width)) {}

  /// `exponent` is written behind the mantissa where it is not zero.
  void try_mantissa(double mantissa, int decimals, int exponent) {
    std::string text = fmt::format("{:.{}f}", mantissa, decimals);
    if (decimals == 0) text += '.';
    const std::size_t zero = text.find("0.");
    const bool leads = zero == 0 || (zero == 1 && text.front() == '-');
    if (leads && decimals > 0) text.erase(zero, 1);
    if (exponent != 0) text += fmt::format("{:+d}", exponent);
    double read = 0.0;
    if (text.size() > width_ || !nastran::parse_real(text, read)) return;
    const double error = std::abs(read - value_);
    const auto rank = std::tuple(error, exponent != 0, text.size());
    if (rank >= rank_) return;
    rank_ = rank;
    text_ = text;
  }

  const std::string& text() const { return text_; }

 private:
  double value_;
  std::size_t width_;
  std::string text_ = {};
  std::tuple<double, bool, std::size_t> rank_ = {std::numeric_limits<double>::infinity(), true, 0};
};

}  // namespace

std::string nastran_real(double value, int width) {
  if (value == 0.0) return "0.";
  BestText best(value, width);
  const int magnitude = static_cast<int>(std::floor(std::log10(std::abs(value))));
  for (int decimals = 0; decimals < width; ++decimals) {
    best.try_mantissa(value, decimals, 0);
    for (int shift = -1; shift < width; ++shift) {  // digits in front of the point, but for one
      const int exponent = magnitude - shift;
      best.try_mantissa(value / std::pow(10.0, exponent), decimals, exponent);
    }
  }
  return best.text();
}

}  // namespace mottle::formats
