// Places for parameters in text.
#include "mottle/drivers/command/template_file.hpp"

#include <gmock/gmock.h>

#include "mottle/core/error.hpp"

namespace {

using mottle::FormatError;
using mottle::drivers::Template;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

const std::vector<std::string> k_names{"E", "t", "n"};

std::string filled(const std::string& text, double e = 2.1e11, double t = 0.1, double n = 3.0) {
  return Template(text, "plate.inp.in", k_names).fill(Eigen::Vector3d(e, t, n));
}

TEST(Placeholders, AreNamedOnceInTheirOrder) {
  EXPECT_THAT(
      mottle::drivers::placeholder_names("a {{t:%8.3f}} {{E*7850:%12.5e}}\n{{ n : %4d}}{{t}} {{plate:T}}", "p.in"),
      ElementsAre("t", "E", "n", "plate:T"));
  EXPECT_THAT([] { mottle::drivers::placeholder_names("\n{{t\n}}", "p.in"); },
              ThrowsMessage<FormatError>(HasSubstr("p.in:2")));
}

TEST(Template, FormatsArePrintfs) {
  EXPECT_EQ(filled("*ELASTIC\n{{E:%12.5e}}, 0.3\n"), "*ELASTIC\n 2.10000e+11, 0.3\n");
  EXPECT_EQ(filled("{{t:%-8.3f}}|{{ n : %4d}}"), "0.100   |   3");
}

TEST(Template, WithoutAFormatTheNumberReadsBackExactly) {
  const double value = 1.0 / 3.0;
  EXPECT_EQ(std::stod(filled("{{t}}", 1.0, value)), value);
}

TEST(Template, AValueMayBeTimesANumber) {
  EXPECT_EQ(filled("{{t*2.5e3}}|{{ t * -4 : %.1f}}"), "250|-0.4");
  EXPECT_THAT([] { filled("{{E*x}}"); }, ThrowsMessage<FormatError>(HasSubstr("'x' in 'E*x' is not a number")));
}

TEST(Template, AValueWiderThanItsPlaceIsNamedWithFileAndLine) {
  EXPECT_THAT([] { filled("first\n{{E:%8.3e}}\n", -2.1e11); },
              ThrowsMessage<FormatError>(testing::AllOf(HasSubstr("plate.inp.in:2: "), HasSubstr("-2.100e+11"))));
  EXPECT_THAT([] { filled("{{n:%4d}}", 1.0, 0.1, 3.5); }, ThrowsMessage<FormatError>(HasSubstr("not a whole number")));
}

TEST(Template, AnUnknownNameIsAnsweredWithTheKnownOnes) {
  EXPECT_THAT([] { filled("\n\n{{EE}}"); },
              ThrowsMessage<FormatError>(testing::AllOf(HasSubstr("plate.inp.in:3: "), HasSubstr("Known: E, t, n"))));
}

TEST(Template, OnlySafeFormatsAreTaken) {
  for (const char* format : {"%s", "%n", "%e%s", "%ld", "%*e", "%100.3e", "%8.123e", "e", "%", "%8.3x"}) {
    EXPECT_THAT([&] { filled(std::string("{{E:") + format + "}}"); }, testing::Throws<FormatError>()) << format;
  }
}

TEST(Template, AnOpenPlaceIsRefused) {
  EXPECT_THAT([] { filled("a\n{{E\n}}"); }, ThrowsMessage<FormatError>(HasSubstr("plate.inp.in:2: ")));
}

TEST(Template, SaysWhichParametersItUses) {
  EXPECT_THAT(Template("{{E}} {{n}}", "f", k_names).uses(3), ElementsAre(true, false, true));
}

TEST(Template, PlacesTooCoarseForAStepAreNamed) {
  const Eigen::Vector3d values(2.1e11, 0.1, 3.0);
  const Eigen::Vector3d steps(1e9, 1e-3, 0.0);
  EXPECT_THAT(Template("{{E:%8.1e}}\n{{t:%6.4f}}", "f", k_names).coarse_placeholders(values, steps),
              ElementsAre("f:1: E as %8.1e"));
  EXPECT_THAT(Template("{{E:%12.5e}} {{t}}", "f", k_names).coarse_placeholders(values, steps), IsEmpty());
}

}  // namespace
