#include "core/parameters/yaml_parameters.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "error_of.hpp"

namespace fail_aware::yaml_parameters_test {
namespace {

struct NoiseParams {
  double sigma_m = 0.05;
  std::vector<double> sigmas_rad = {0.1};

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("sigma_m", self.sigma_m);
    v("sigmas_rad", self.sigmas_rad);
  }
};

struct FilterParams {
  NoiseParams noise;
  int steps = 3;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("noise", self.noise);
    v("steps", self.steps);
  }
};

struct Params {
  bool enabled = true;
  FilterParams filter;
  std::string source = "auto";

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("enabled", self.enabled);
    v("filter", self.filter);
    v("source", self.source);
  }
};

std::string parseError(const std::string& text) {
  return errorOf([&] { parseYaml(text, "a.yaml"); });
}

ParameterValue parsed(const std::string& scalar) { return parseYaml("k: " + scalar + '\n', "a.yaml").values.at("k"); }

class YamlFile : public testing::Test {
 protected:
  YamlFile()
      : path_(std::filesystem::temp_directory_path() /
              (std::string("yaml_parameters_") + testing::UnitTest::GetInstance()->current_test_info()->name() +
               ".yaml")) {}
  ~YamlFile() override { std::filesystem::remove(path_); }
  void write(const std::string& text) const { std::ofstream(path_) << text; }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

TEST(ParseYaml, NestedMapsBecomeDottedKeysWithLines) {
  const YamlParameters yaml =
      parseYaml("# a comment\nenabled: false\nfilter:\n  noise: {sigma_m: 0.25}\n  steps: 4\n", "");
  EXPECT_EQ(yaml.values, (ParameterMap{{"enabled", false}, {"filter.noise.sigma_m", 0.25}, {"filter.steps", 4}}));
  EXPECT_EQ(yaml.lines.at("filter.noise.sigma_m"), 4);
  EXPECT_EQ(yaml.lines.at("filter.steps"), 5);
  EXPECT_TRUE(parseYaml("", "").values.empty());
  EXPECT_TRUE(parseYaml("# nothing\n", "").values.empty());
}

TEST(ParseYaml, ScalarsHaveRosparamsTypes) {
  EXPECT_EQ(parsed("true"), ParameterValue(true));
  EXPECT_EQ(parsed("off"), ParameterValue(false));
  EXPECT_EQ(parsed("-12"), ParameterValue(-12));
  EXPECT_EQ(parsed("12."), ParameterValue(12.0));
  EXPECT_EQ(parsed(".5"), ParameterValue(0.5));
  EXPECT_EQ(parsed("-1.5e-03"), ParameterValue(-1.5e-3));
  EXPECT_EQ(parsed("-.inf"), ParameterValue(-HUGE_VAL));
  EXPECT_EQ(parsed("azimuth"), ParameterValue(std::string("azimuth")));
  EXPECT_EQ(parsed("'12'"), ParameterValue(std::string("12")));
  EXPECT_EQ(parsed("\"true\""), ParameterValue(std::string("true")));
  EXPECT_EQ(parsed("[1, 2.5]"), ParameterValue(std::vector<double>{1.0, 2.5}));
  EXPECT_EQ(parsed("[]"), ParameterValue(std::vector<double>{}));
}

TEST(ParseYaml, RefusesNumbersThatRosparamReadsDifferently) {
  for (const char* scalar :
       {"1e-3", "1.0e3", "1E5", "-.5", "010", "0x1F", "1_000", "1:30", "1.2.3", ".nan", "1.0e+999", "3000000000"}) {
    EXPECT_THROW(parsed(scalar), ParameterError) << scalar;
  }
}

TEST(ParseYaml, ErrorsNameFileLineAndKey) {
  EXPECT_EQ(
      parseError("a: 1\ng:\n  b: 1e-3\n"),
      "a.yaml:3: g.b: 1e-3 is not read as a number everywhere: write 12, 0.5 or 1.0e-3, or quote it if it is text");
  EXPECT_EQ(parseError("a: 1\na: 2\n"), "a.yaml:2: a: given twice");
  EXPECT_EQ(parseError("g: {a: 1}\nb: 1\ng: {c: 2}\n"), "a.yaml:3: g: given twice");
  EXPECT_EQ(parseError("a:\n"), "a.yaml:1: a: has no value");
  EXPECT_EQ(parseError("a.b: 1\n"), "a.yaml:1: a.b: a key is made of letters, digits and _; groups are nested");
  EXPECT_EQ(parseError("a: [1, x]\n"), "a.yaml:1: a: a list may hold numbers only");
  EXPECT_EQ(parseError("a: [[1], 2]\n"), "a.yaml:1: a: a list may hold numbers only");
  EXPECT_EQ(parseError("- 1\n- 2\n"), "a.yaml:1: must be a map of parameters");
  EXPECT_EQ(parseError("a: 1\n---\nb: 2\n"), "a.yaml: must hold one yaml document");
  EXPECT_EQ(parseError("a: 1\nb: [1, 2\n").substr(0, 7), "a.yaml:");
  EXPECT_EQ(parseError(",").substr(0, 7), "a.yaml:") << "a stray comma ends, too";
  EXPECT_EQ(parseError("a: 1\n, b: 2\n").substr(0, 7), "a.yaml:");
}

TEST_F(YamlFile, LoadsASubsetOnlyWhenTold) {
  write("filter:\n  steps: 9\n");
  Params params;
  EXPECT_EQ(errorOf([&] { loadYaml(path(), params); }), path() + ": enabled: missing");
  EXPECT_EQ(params.filter.steps, 3);
  loadYaml(path(), params, MissingKeys::kKeep);
  EXPECT_EQ(params.filter.steps, 9);
  EXPECT_EQ(params.source, "auto");
}

TEST_F(YamlFile, TextOfWindowsIsRead) {
  const YamlParameters yaml = parseYaml(
      "\xEF\xBB\xBF"
      "filter:\r\n  steps: 7 # of them\r\nsource: \"none\"\r\nenabled: no\r\n",
      "p");
  EXPECT_EQ(std::get<int>(yaml.values.at("filter.steps")), 7);
  EXPECT_EQ(std::get<std::string>(yaml.values.at("source")), "none");
  EXPECT_EQ(std::get<bool>(yaml.values.at("enabled")), false);
}

TEST_F(YamlFile, UnknownKeysAndWrongTypesNameTheLine) {
  Params params;
  write("enabled: true\nfilter:\n  noise:\n    sigma: 0.1\n");
  EXPECT_EQ(errorOf([&] { loadYaml(path(), params, MissingKeys::kKeep); }),
            path() + ":4: filter.noise.sigma: unknown parameter, did you mean filter.noise.sigma_m?");
  write("\nfilter:\n  steps: few\n");
  EXPECT_EQ(errorOf([&] { loadYaml(path(), params, MissingKeys::kKeep); }),
            path() + ":3: filter.steps: must be an int, not the text \"few\"");
  write("\nfilter: 3\n");
  EXPECT_EQ(errorOf([&] { loadYaml(path(), params, MissingKeys::kKeep); }),
            path() + ":2: filter: is a group of parameters, such as filter.noise.sigma_m");
}

TEST_F(YamlFile, ATabThatIndentsIsNamed) {
  EXPECT_EQ(errorOf([] { parseYaml("enabled: true\n# a\tcomment\nfilter:\n  \tsteps: 3\n", "p"); }),
            "p:4: a tab indents this line: use blanks");
  EXPECT_EQ(errorOf([] { parseYaml("filter:\n\tsteps: 3\n", "p"); }), "p:2: a tab indents this line: use blanks");
  EXPECT_EQ(std::get<int>(parseYaml("filter:\n  steps: 3\t# three\n", "p").values.at("filter.steps")), 3);
}

TEST_F(YamlFile, FileThatCannotBeReadOrWritten) {
  Params params;
  EXPECT_EQ(errorOf([&] { loadYaml("/nowhere/a.yaml", params); }), "/nowhere/a.yaml: cannot be read");
  EXPECT_EQ(errorOf([&] { loadYaml("/", params); }), "/: cannot be read");
  EXPECT_EQ(errorOf([&] { saveYaml("/nowhere/a.yaml", params); }), "/nowhere/a.yaml: cannot be written");
}

TEST_F(YamlFile, SavesWhatItLoads) {
  Params params;
  params.enabled = false;
  params.filter.noise.sigma_m = 1.0 / 3.0;
  params.filter.noise.sigmas_rad = {1e-9, 2.0, HUGE_VAL};
  params.filter.steps = -1;
  params.source = "a \"b\": #c\n12";
  saveYaml(path(), params);
  Params read;
  loadYaml(path(), read);
  EXPECT_EQ(toMap(read), toMap(params));
}

TEST(FormatYaml, KeepsOrderAndNesting) {
  EXPECT_EQ(formatYaml(toList(Params())),
            "enabled: true\n"
            "filter:\n"
            "  noise:\n"
            "    sigma_m: 0.05\n"
            "    sigmas_rad: [0.1]\n"
            "  steps: 3\n"
            "source: \"auto\"\n");
}

}  // namespace
}  // namespace fail_aware::yaml_parameters_test
