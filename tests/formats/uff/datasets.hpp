// Universal files for tests, as other programs lay them out (the published layout of each dataset).
#pragma once

#include <string>

namespace mottle::test {

inline const std::string k_uff_titles = "NONE\nNONE\nNONE\nNONE\nNONE\n";

/// A dataset with its marks.
inline std::string dataset(const std::string& number, const std::string& records) {
  return "    -1\n" + std::string(6 - number.size(), ' ') + number + "\n" + records + "    -1\n";
}

/// A normal mode at nodes 1 and 2, seven lines of head.
inline const std::string k_uff_mode = k_uff_titles +
                                      "         1         2         2         8         2         3\n"
                                      "         2         4         1         3\n"
                                      "  1.25000E+01  2.00000E+00  1.00000E-02  0.00000E+00\n"
                                      "         1\n"
                                      "  1.00000E+00 -5.00000E-01  0.00000E+00\n"
                                      "         2\n"
                                      "  0.00000E+00  2.50000E-01 -1.00000E+00\n";

/// Head of a function: titles, degrees of freedom, form, four axes.
inline std::string function_head(const std::string& form) {
  return k_uff_titles + "    4         0    0         0       NONE       101   3       NONE       205  -1\n" + form +
         "        18    0    0    0 Frequency            Hz                  \n"
         "        12    0    0    0 Acceleration         m/s^2               \n"
         "        13    0    0    0 Force                N                   \n"
         "         0    0    0    0 NONE                 NONE                \n";
}

}  // namespace mottle::test
