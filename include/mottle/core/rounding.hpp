// Fewer digits for numbers that are only drawn.
#pragma once

namespace mottle {

/// Significant digits that keep six digits of the range of values: more in a narrow range far from zero, where the
/// leading digits are all equal; 17, all of a double's, where there is no range.
///
/// @param range    greatest minus least of the values
/// @param largest  greatest absolute value
int digits_of_range(double range, double largest);

/// `value` with so many significant digits; what is not finite as it is.
double rounded(double value, int digits);

}  // namespace mottle
