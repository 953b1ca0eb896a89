#include "mottle/fem/elements/beam_section.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

using Dimensions = std::span<const double>;

constexpr double k_solid = 5.0 / 6.0;  // shear factor of a rectangle

/// A rectangle of an outline; sizes along y and z.
struct Rectangle {
  double y = 0.0, z = 0.0;  ///< centre
  double height = 0.0, width = 0.0;

  double area() const { return height * width; }
};

double cube(double x) {
  return x * x * x;
}

/// J of a thin strip, [Young2002].
double strip(double length, double thickness) {
  return length * cube(thickness) / 3.0;
}

/// Area and inertias about the centroid of rectangles that do not overlap.
BeamSection composed(std::initializer_list<Rectangle> rectangles) {
  BeamSection section;
  double y = 0.0, z = 0.0;
  for (const Rectangle& part : rectangles) {
    section.area += part.area();
    y += part.area() * part.y;
    z += part.area() * part.z;
  }
  y /= section.area;
  z /= section.area;
  for (const Rectangle& part : rectangles) {
    section.inertia_1 += part.area() * (part.height * part.height / 12.0 + (part.y - y) * (part.y - y));
    section.inertia_2 += part.area() * (part.width * part.width / 12.0 + (part.z - z) * (part.z - z));
    section.inertia_12 += part.area() * (part.y - y) * (part.z - z);
  }
  return section;
}

/// Completes an open or closed thin-walled section.
/// @param walls_1, walls_2  effective shear areas in planes 1 and 2
BeamSection finished(BeamSection section, double torsion, double walls_1, double walls_2) {
  section.torsion = torsion;
  section.shear_1 = walls_1 / section.area;
  section.shear_2 = walls_2 / section.area;
  return section;
}

BeamSection annulus(double outer, double inner, double shear) {
  const double inertia = std::numbers::pi / 4.0 * (std::pow(outer, 4) - std::pow(inner, 4));
  return {.area = std::numbers::pi * (outer * outer - inner * inner),
          .inertia_1 = inertia,
          .inertia_2 = inertia,
          .torsion = 2.0 * inertia,
          .shear_1 = shear,
          .shear_2 = shear};
}

BeamSection rod(Dimensions d) {
  return annulus(d[0], 0.0, 0.9);
}

BeamSection tube(Dimensions d) {
  require(d[1] < d[0], "TUBE: the inner radius {:g} must be smaller than the outer, {:g}", d[1], d[0]);
  return annulus(d[0], d[1], 0.5);
}

BeamSection tube_by_thickness(Dimensions d) {
  require(d[1] <= d[0], "TUBE2: the thickness {:g} must not be larger than the radius, {:g}", d[1], d[0]);
  return annulus(d[0], d[0] - d[1], 0.5);
}

BeamSection bar(Dimensions d) {
  const double a = std::max(d[0], d[1]), b = std::min(d[0], d[1]);
  const double torsion = a * cube(b) * (1.0 / 3.0 - 0.21 * b / a * (1.0 - std::pow(b / a, 4) / 12.0));
  return finished(composed({{.height = d[1], .width = d[0]}}), torsion, k_solid * a * b, k_solid * a * b);
}

BeamSection box(Dimensions d) {
  const double width = d[0], height = d[1], lying = d[2], standing = d[3];
  require(2.0 * standing < width && 2.0 * lying < height, "BOX: walls of {:g} and {:g} leave no room in {:g} x {:g}",
          standing, lying, width, height);
  const double clear_width = width - 2.0 * standing, clear_height = height - 2.0 * lying;
  const Rectangle top = {.y = 0.5 * (height - lying), .height = lying, .width = width};
  const Rectangle bottom = {.y = -top.y, .height = lying, .width = width};
  const Rectangle right = {.z = 0.5 * (width - standing), .height = clear_height, .width = standing};
  const Rectangle left = {.z = -right.z, .height = clear_height, .width = standing};
  const double b = width - standing, h = height - lying;
  const double torsion = 2.0 * b * b * h * h / (b / lying + h / standing);
  return finished(composed({top, bottom, right, left}), torsion, 2.0 * clear_height * standing,
                  2.0 * clear_width * lying);
}

BeamSection channel_of(double width, double height, double web, double flange) {
  require(web < width && 2.0 * flange < height, "CHAN: walls of {:g} and {:g} leave no room in {:g} x {:g}", web,
          flange, width, height);
  const double clear_width = width - web, clear_height = height - 2.0 * flange;
  const double middle = 0.5 * (web + clear_width), edge = 0.5 * (height - flange);
  const BeamSection section = composed({{.height = height, .width = web},
                                        {.y = edge, .z = middle, .height = flange, .width = clear_width},
                                        {.y = -edge, .z = middle, .height = flange, .width = clear_width}});
  const double torsion = 2.0 * strip(width - 0.5 * web, flange) + strip(height - flange, web);
  BeamSection whole = finished(section, torsion, clear_height * web, 2.0 * clear_width * flange);
  whole.inertia_12 = 0.0;  // symmetric; sums leave a rounding error
  return whole;
}

BeamSection channel(Dimensions d) {
  return channel_of(d[0], d[1], d[2], d[3]);
}

BeamSection channel_by_clear_height(Dimensions d) {
  require(d[2] < d[3], "CHAN1: the clear height {:g} must be smaller than the height, {:g}", d[2], d[3]);
  return channel_of(d[0] + d[1], d[3], d[1], 0.5 * (d[3] - d[2]));
}

BeamSection cross(Dimensions d) {
  const double arms = d[0], stem = d[1], height = d[2], thickness = d[3];
  require(thickness <= height, "CROSS: arms of thickness {:g} do not fit a stem of height {:g}", thickness, height);
  const double middle = 0.5 * stem + 0.25 * arms;
  const BeamSection section = composed({{.height = height, .width = stem},
                                        {.z = middle, .height = thickness, .width = 0.5 * arms},
                                        {.z = -middle, .height = thickness, .width = 0.5 * arms}});
  return finished(section, strip(height, stem) + strip(arms, thickness), k_solid * height * stem,
                  k_solid * (arms + stem) * thickness);
}

BeamSection standing_flanges(Dimensions d) {
  const double clear = d[0], flange = 0.5 * d[1], height = d[2], web = d[3];
  require(web <= height, "H: a web of thickness {:g} does not fit flanges of height {:g}", web, height);
  const double middle = 0.5 * (clear + flange);
  const BeamSection section = composed({{.height = web, .width = clear},
                                        {.z = middle, .height = height, .width = flange},
                                        {.z = -middle, .height = height, .width = flange}});
  return finished(section, 2.0 * strip(height, flange) + strip(clear + flange, web), k_solid * 2.0 * height * flange,
                  clear * web);
}

BeamSection hat(Dimensions d) {
  const double height = d[0], t = d[1], top = d[2], brim = d[3];
  require(2.0 * t < height && 2.0 * t < top, "HAT: walls of {:g} leave no room in {:g} x {:g}", t, top, height);
  const double clear = height - 2.0 * t;
  const double web = 0.5 * (top - t), foot = 0.5 * (top + brim - t), low = 0.5 * (t - height);
  const double foot_width = brim + t;
  const BeamSection section = composed({{.y = -low, .height = t, .width = top},
                                        {.z = web, .height = clear, .width = t},
                                        {.z = -web, .height = clear, .width = t},
                                        {.y = low, .z = foot, .height = t, .width = foot_width},
                                        {.y = low, .z = -foot, .height = t, .width = foot_width}});
  const double centre_line = (top - t) + 2.0 * (height - t) + 2.0 * (brim + 0.5 * t);
  return finished(section, strip(centre_line, t), 2.0 * clear * t, (top - 2.0 * t + 2.0 * brim) * t);
}

BeamSection double_tee(double height, double bottom, double top, double web, double lower, double upper) {
  require(lower + upper < height, "I: flanges of {:g} and {:g} leave no room in a height of {:g}", lower, upper,
          height);
  require(web <= bottom && web <= top, "I: the web of {:g} is wider than a flange", web);
  const double clear = height - lower - upper;
  const BeamSection section = composed({{.y = 0.5 * lower, .height = lower, .width = bottom},
                                        {.y = lower + 0.5 * clear, .height = clear, .width = web},
                                        {.y = height - 0.5 * upper, .height = upper, .width = top}});
  const double torsion = strip(bottom, lower) + strip(top, upper) + strip(height - 0.5 * (lower + upper), web);
  return finished(section, torsion, clear * web, k_solid * (bottom * lower + top * upper));
}

BeamSection i_section(Dimensions d) {
  return double_tee(d[0], d[1], d[2], d[3], d[4], d[5]);
}

BeamSection i_by_clear_height(Dimensions d) {
  require(d[2] < d[3], "I1: the clear height {:g} must be smaller than the height, {:g}", d[2], d[3]);
  const double width = d[0] + d[1], flange = 0.5 * (d[3] - d[2]);
  return double_tee(d[3], width, width, d[1], flange, flange);
}

BeamSection angle(Dimensions d) {
  const double width = d[0], height = d[1], lying = d[2], standing = d[3];
  require(standing < width && lying < height, "L: legs of {:g} and {:g} leave no room in {:g} x {:g}", standing, lying,
          width, height);
  const double clear_width = width - standing, clear_height = height - lying;
  const BeamSection section =
      composed({{.y = 0.5 * lying, .z = 0.5 * width, .height = lying, .width = width},
                {.y = lying + 0.5 * clear_height, .z = 0.5 * standing, .height = clear_height, .width = standing}});
  const double torsion = strip(width - 0.5 * standing, lying) + strip(height - 0.5 * lying, standing);
  return finished(section, torsion, clear_height * standing, clear_width * lying);
}

BeamSection tee(Dimensions d) {
  const double width = d[0], height = d[1], flange = d[2], stem = d[3];
  require(flange < height && stem <= width, "T: a flange of {:g} and a stem of {:g} do not fit {:g} x {:g}", flange,
          stem, width, height);
  const double clear = height - flange;
  const BeamSection section = composed({{.y = clear + 0.5 * flange, .height = flange, .width = width},
                                        {.y = 0.5 * clear, .height = clear, .width = stem}});
  return finished(section, strip(width, flange) + strip(height - 0.5 * flange, stem), clear * stem,
                  k_solid * width * flange);
}

struct KnownSection {
  std::string_view name;
  int dimensions;
  BeamSection (*numbers)(Dimensions);
};

constexpr std::array k_sections = {
    KnownSection{"BAR", 2, bar},
    KnownSection{"BOX", 4, box},
    KnownSection{"CHAN", 4, channel},
    KnownSection{"CHAN1", 4, channel_by_clear_height},
    KnownSection{"CROSS", 4, cross},
    KnownSection{"H", 4, standing_flanges},
    KnownSection{"HAT", 4, hat},
    KnownSection{"I", 6, i_section},
    KnownSection{"I1", 4, i_by_clear_height},
    KnownSection{"L", 4, angle},
    KnownSection{"ROD", 1, rod},
    KnownSection{"T", 4, tee},
    KnownSection{"T2", 4, tee},
    KnownSection{"TUBE", 2, tube},
    KnownSection{"TUBE2", 2, tube_by_thickness},
};

const KnownSection* find(std::string_view name) {
  const auto* found = std::ranges::find(k_sections, name, &KnownSection::name);
  return found == k_sections.end() ? nullptr : found;
}

}  // namespace

std::vector<std::string> beam_section_names() {
  std::vector<std::string> names;
  for (const KnownSection& section : k_sections) names.emplace_back(section.name);
  return names;
}

int beam_section_dimensions(std::string_view name) {
  const KnownSection* section = find(name);
  return section == nullptr ? 0 : section->dimensions;
}

BeamSection beam_section(std::string_view name, std::span<const double> dimensions) {
  const KnownSection* section = find(name);
  require(section != nullptr, "beam section '{}' is not known, allowed are {}", name,
          fmt::join(beam_section_names(), ", "));
  require(static_cast<int>(dimensions.size()) == section->dimensions, "beam section {}: {} dimensions, {} are needed",
          name, dimensions.size(), section->dimensions);
  for (std::size_t i = 0; i < dimensions.size(); ++i) {
    const bool may_be_zero = name == "TUBE" && i == 1;
    require(std::isfinite(dimensions[i]) && (dimensions[i] > 0.0 || (may_be_zero && dimensions[i] == 0.0)),
            "beam section {}: DIM{} is {:g}, a length > 0 is needed", name, i + 1, dimensions[i]);
  }
  return section->numbers(dimensions);
}

}  // namespace mottle::fem
