#include "mottle/model/structures/structure.hpp"

#include <algorithm>

namespace mottle::model {

ObservationMatrix selected_equations(const std::vector<int>& degrees_of_freedom, Eigen::Index equations) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < degrees_of_freedom.size(); ++k) {
    entries.emplace_back(static_cast<int>(k), degrees_of_freedom[k], 1.0);
  }
  ObservationMatrix selected(static_cast<Eigen::Index>(degrees_of_freedom.size()), equations);
  selected.setFromTriplets(entries.begin(), entries.end());
  return selected;
}

std::vector<int> find_degrees_of_freedom(const Structure& structure, const std::vector<std::string>& names,
                                         const Subject& subject) {
  std::vector<int> numbers;
  for (const std::string& name : names) {
    const int number = structure.find_degree_of_freedom(name);
    if (number < 0) throw SubjectError(subject, structure.unknown_degree_of_freedom(name));
    require_of(std::find(numbers.begin(), numbers.end(), number) == numbers.end(), subject, "'{}' is given twice",
               name);
    numbers.push_back(number);
  }
  require_of(!names.empty(), subject, "{}", structure.unknown_degree_of_freedom(""));
  return numbers;
}

}  // namespace mottle::model
