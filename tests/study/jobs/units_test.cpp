// One study in several systems of units, and tests that state a unit.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::StudyFolder;
using testing::HasSubstr;

/// What one SI unit of each quantity is in a system.
struct UnitSystem {
  std::string name;
  double mass, stiffness, damping, frequency, shape;  ///< shapes are mass-normalised
};

const UnitSystem k_si{"SI", 1.0, 1.0, 1.0, 1.0, 1.0};
const UnitSystem k_mm_t_s{"mm-t-s", 1e-3, 1e-3, 1e-3, 1.0, std::sqrt(1e3)};
const UnitSystem k_mm_kg_ms{"mm-kg-ms", 1.0, 1e-6, 1e-3, 1e-3, 1.0};
const std::vector<std::string> k_outputs{"f1", "f2", "f3", "phi1:m1", "phi1:m3", "zeta1", "zeta2"};

/// Number of each output in a system over its number in SI.
std::vector<double> sizes(const UnitSystem& system) {
  std::vector<double> result;
  for (const std::string& name : k_outputs) {
    result.push_back(name[0] == 'f' ? system.frequency : name[0] == 'p' ? system.shape : 1.0);
  }
  return result;
}

/// Parameters are factors on nominal values: the same numbers in every system.
std::string study_in(const UnitSystem& system, const std::string& method, const std::string& options = "") {
  std::string text =
      fmt::format("title = \"Units\"\nunits = \"{}\"\nseed = 5\n[model]\nkind = \"mass-spring\"\n", system.name);
  text += fmt::format("masses = {{ m1 = {0}, m2 = {0}, m3 = {0} }}\nsprings = [\n", system.mass);
  const std::vector<std::tuple<std::string, std::string, std::string, double>> springs{
      {"k1", "ground", "m1", 1.0}, {"k2", "ground", "m2", 1.0}, {"k3", "ground", "m3", 1.0},
      {"k4", "m1", "m2", 1.0},     {"k5", "m2", "m3", 1.0},     {"k6", "m1", "m3", 3.0}};
  for (const auto& [name, a, b, stiffness] : springs) {
    text += fmt::format("  {{ name = \"{}\", between = [\"{}\", \"{}\"], stiffness = {} }},\n", name, a, b,
                        stiffness * system.stiffness);
  }
  text += fmt::format("]\ndampers = [{{ name = \"c1\", between = [\"ground\", \"m1\"], damping = {} }}]\n",
                      0.05 * system.damping);
  for (const char* name : {"k1", "k2"}) {
    text += fmt::format(
        "[[parameter]]\nname = \"{0}\"\ntarget = \"spring:{0}\"\nrelative = true\n"
        "distribution = {{ kind = \"normal\", mean = 1.2, std = 0.2 }}\n",
        name);
  }
  return text +
         "[outputs]\nfrequencies = [1, 2, 3]\nshapes = { modes = [1], dofs = [\"m1\", \"m3\"] }\n"
         "damping = [1, 2]\n[test]\nfile = \"tests.csv\"\n[update]\nmethod = \"" +
         method + "\"\nsamples = 400\n" + options +
         "[truth]\nspecimens = 8\nnoise = { \"f*\" = 0.002, \"phi*\" = 0.01, \"zeta*\" = 0.0005 }\n";
}

/// Tests of the truth in a system.
std::string tests_in(const UnitSystem& system) {
  static const test::WrittenTable drawn = [] {
    StudyFolder folder;
    folder.write("study.toml", study_in(k_si, "maximum-likelihood"));
    return folder.simulate();
  }();
  std::vector<std::vector<double>> rows(drawn.rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t k = 0; k < k_outputs.size(); ++k) {
      rows[i].push_back(drawn.numbers(k_outputs[k])[i] * sizes(system)[k]);
    }
  }
  return test::csv_text(fmt::format("{}", fmt::join(k_outputs, ",")), rows);
}

nlohmann::json updated(const UnitSystem& system, const std::string& method, const std::string& options = "") {
  StudyFolder folder;
  folder.write("study.toml", study_in(system, method, options));
  folder.write("tests.csv", tests_in(system));
  return folder.update();
}

/// A vector or a matrix of outputs in SI.
nlohmann::json outputs_in_si(const nlohmann::json& value, const std::vector<double>& size) {
  nlohmann::json scaled = value;
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (value[i].is_number()) scaled[i] = value[i].get<double>() / size[i];
    for (std::size_t j = 0; value[i].is_array() && j < value[i].size(); ++j) {
      scaled[i][j] = value[i][j].get<double>() / size[i] / size[j];
    }
  }
  return scaled;
}

/// Everything in a result that depends on the parameters or the outputs, with the outputs in SI.
nlohmann::json in_si(const nlohmann::json& result, const UnitSystem& system) {
  const std::vector<double> size = sizes(system);
  nlohmann::json kept;
  for (const char* key : {"status", "verdict", "outliers", "other_solutions", "specimens", "identifiability",
                          "spearman", "sample_size"}) {
    kept[key] = result[key];
  }
  kept["sample_size"].erase("monte_carlo_error");
  for (nlohmann::json& error : kept["verdict"]["could_hide"]) {  // of the study's units
    error.erase("nominal");
    error.erase("change");
  }
  for (nlohmann::json& step : kept["verdict"]["next"]) step.erase("command");  // names the study's file
  for (const auto& [key, value] : result["outputs"].items()) {
    if (!value.is_null() && key != "names" && key != "units" && key != "test_count") {
      kept["outputs"][key] = outputs_in_si(value, size);
    }
  }
  kept["parameters"] = result["parameters"];
  for (const char* key : {"units", "prior", "factor_of", "factor_units"}) kept["parameters"].erase(key);
  kept["sensitivity"] = result["regression"]["sensitivity"];
  for (std::size_t i = 0; i < size.size(); ++i) {
    for (nlohmann::json& slope : kept["sensitivity"][i]) slope = slope.get<double>() / size[i];
  }
  kept["iterations"] = nlohmann::json::array();
  for (const nlohmann::json& state : result["iterations"]) {
    kept["iterations"].push_back(
        {state["distance_mahalanobis"], state["parameter_mean"], state["parameter_covariance"]});
  }
  return kept;
}

/// The first two steps of a number's path: numbers of one list are compared by the largest of them.
std::string place_of(const std::string& pointer) {
  const std::size_t second = pointer.find('/', pointer.find('/', 1) + 1);
  return pointer.substr(0, second);
}

/// Rounding of the converted tests and masses decides at which point an iteration ends, whose steps are then below 1e-3
/// of a deviation and fall by a hundred each time: 1e-5 of the largest number beside it (5e-7 was seen), far below any
/// effect of a unit.
void expect_same_in_every_system(const std::string& method, const std::string& options = "") {
  const nlohmann::json expected = in_si(updated(k_si, method, options), k_si).flatten();
  std::map<std::string, double> largest;
  for (const auto& [path, value] : expected.items()) {
    if (value.is_number_float()) {
      double& of_place = largest[place_of(path)];
      of_place = std::max(of_place, std::abs(value.get<double>()));
    }
  }
  for (const UnitSystem& system : {k_mm_t_s, k_mm_kg_ms}) {
    SCOPED_TRACE(method + " in " + system.name);
    const nlohmann::json found = in_si(updated(system, method, options), system).flatten();
    ASSERT_EQ(found.size(), expected.size());
    for (const auto& [path, value] : expected.items()) {
      ASSERT_TRUE(found.contains(path)) << path;
      if (value.is_number_float() && found[path].is_number()) {
        EXPECT_NEAR(found[path].get<double>(), value.get<double>(), 1e-5 * largest[place_of(path)]) << path;
      } else {
        EXPECT_EQ(found[path], value) << path;
      }
    }
  }
}

TEST(Units, ChangeNoResultWithEstimatedNoise) {
  expect_same_in_every_system("maximum-likelihood", "[update.maximum-likelihood]\nnoise = \"estimated\"\n");
}

TEST(Units, ChangeNoResultOfAnyMethod) {
  for (const char* method : {"mares", "inversion", "perturbation", "covariance-adjustment", "moment-matching"}) {
    expect_same_in_every_system(method);
  }
}

TEST(Units, LeaveTheNoiseOfFrequenciesInKilohertzAPartOfTheirValue) {
  const auto parts = [](const UnitSystem& system) {
    const nlohmann::json outputs = updated(system, "maximum-likelihood")["outputs"];
    std::vector<double> found;
    for (std::size_t k = 0; k < 3; ++k) {
      found.push_back(outputs["noise_std"][k].get<double>() / outputs["test_mean"][k].get<double>());
    }
    return found;
  };
  const std::vector<double> kilohertz = parts(k_mm_kg_ms);
  const std::vector<double> hertz = parts(k_si);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(kilohertz[k] / hertz[k], 1.0, 1e-3) << k;
}

/// A table whose column of `name` has another title.
StudyFolder& with_title(StudyFolder& folder, const UnitSystem& system, const std::string& name,
                        const std::string& title) {
  std::string table = tests_in(system);
  table.replace(table.find(name + ","), name.size(), title);
  folder.write("tests.csv", table);
  folder.write("study.toml", study_in(system, "mares"));
  return folder;
}

TEST(Units, OfAColumnThatAreNotTheStudysAreRefused) {
  StudyFolder folder;
  for (const auto& [title, system] : std::vector<std::pair<std::string, UnitSystem>>{{"f1_Hz", k_mm_kg_ms},
                                                                                     {"f1 [kHz]", k_si},
                                                                                     {"f1_kHz", k_si},
                                                                                     {"f1 (rad/s)", k_mm_t_s},
                                                                                     {"f1 [rpm]", k_si},
                                                                                     {"zeta1 [%]", k_si}}) {
    SCOPED_TRACE(title + " in " + system.name);
    const std::string name = title[0] == 'z' ? "zeta1" : "f1";
    test::expect_message(with_title(folder, system, name, title).refusal(), {"tests.csv:1", "'" + title + "'"});
  }
}

TEST(Units, OfAColumnMayBeTheStudys) {
  StudyFolder folder;
  for (const auto& [title, system] : std::vector<std::pair<std::string, UnitSystem>>{
           {"f1_kHz", k_mm_kg_ms}, {"f1 [kHz]", k_mm_kg_ms}, {"f1_Hz", k_si}, {"f1 (Hz)", k_mm_t_s}}) {
    EXPECT_NO_THROW(with_title(folder, system, "f1", title).check()) << title;
  }
}

}  // namespace
}  // namespace mottle::study
