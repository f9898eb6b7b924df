#include "core/parameters/parameter_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "error_of.hpp"

namespace fail_aware::parameter_map_test {
namespace {

struct UkfParams {
  double alpha = 0.5;
  int order = 2;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("alpha", self.alpha);
    v("order", self.order);
  }
};

struct Params {
  UkfParams ukf;
  bool enabled = true;
  std::string source = "auto";
  std::vector<double> offsets_m = {1.0, -2.0};
  double range_m = 120.0;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("ukf", self.ukf);
    v("enabled", self.enabled);
    v("source", self.source);
    v("offsets_m", self.offsets_m);
    v("range_m", self.range_m);
  }
};

TEST(ParameterMap, ListsNestedFieldsInTheirOrder) {
  const ParameterList list = toList(Params());
  std::vector<std::string> keys;
  for (const auto& [key, value] : list) keys.push_back(key);
  EXPECT_EQ(keys, (std::vector<std::string>{"ukf.alpha", "ukf.order", "enabled", "source", "offsets_m", "range_m"}));
  EXPECT_EQ(std::get<double>(list[0].second), 0.5);
  EXPECT_EQ(std::get<int>(list[1].second), 2);
  EXPECT_EQ(std::get<bool>(list[2].second), true);
  EXPECT_EQ(std::get<std::string>(list[3].second), "auto");
}

TEST(ParameterMap, MapGoesThereAndBack) {
  Params changed;
  changed.ukf.alpha = 0.25;
  changed.ukf.order = -7;
  changed.enabled = false;
  changed.source = "";
  changed.offsets_m.clear();
  changed.range_m = std::numeric_limits<double>::infinity();
  Params read;
  fromMap(read, toMap(changed));
  EXPECT_EQ(toMap(read), toMap(changed));
  EXPECT_NE(toMap(read), toMap(Params()));
}

TEST(ParameterMap, IntStandsForDoubleButNotTheOtherWayRound) {
  Params params;
  fromMap(params, {{"range_m", 80}}, MissingKeys::kKeep);
  EXPECT_EQ(params.range_m, 80.0);
  EXPECT_EQ(errorOf([&] {
              fromMap(params, {{"ukf.order", 3.0}}, MissingKeys::kKeep);
            }),
            "ukf.order: must be an int, not a number");
}

TEST(ParameterMap, RefusesOtherTypes) {
  Params params;
  const auto error = [&](const char* key, ParameterValue value) {
    return errorOf([&] { fromMap(params, {{key, std::move(value)}}, MissingKeys::kKeep); });
  };
  EXPECT_EQ(error("enabled", 1), "enabled: must be a bool, not an int");
  EXPECT_EQ(error("ukf.order", true), "ukf.order: must be an int, not a bool");
  EXPECT_EQ(error("range_m", true), "range_m: must be a number, not a bool");
  EXPECT_EQ(error("range_m", std::string("far")), "range_m: must be a number, not the text \"far\"");
  EXPECT_EQ(error("range_m", std::string("1e-4")), "range_m: must be a number, not the text \"1e-4\"; write 0.0001")
      << "as rosparam reads it";
  EXPECT_EQ(error("range_m", std::nan("")), "range_m: must be a number, not NaN");
  EXPECT_EQ(error("source", 3), "source: must be text, not an int");
  EXPECT_EQ(error("offsets_m", 3.0), "offsets_m: must be a list of numbers, not a number");
  EXPECT_EQ(error("offsets_m", std::vector<double>{0.0, std::nan("")}),
            "offsets_m: must be a list of numbers, not one with NaN");
}

TEST(ParameterMap, MissingKeysAreRefusedOrKept) {
  Params params;
  ParameterMap values = toMap(params);
  values["range_m"] = 7.0;
  values.erase("ukf.alpha");
  EXPECT_EQ(errorOf([&] { fromMap(params, values); }), "ukf.alpha: missing");
  EXPECT_EQ(params.range_m, 120.0);
  fromMap(params, values, MissingKeys::kKeep);
  EXPECT_EQ(params.range_m, 7.0);
  EXPECT_EQ(params.ukf.alpha, 0.5);
}

TEST(ParameterMap, StructIsUntouchedByAMapThatFails) {
  Params params;
  EXPECT_THROW(fromMap(params, {{"enabled", false}, {"zzz", 1}}, MissingKeys::kKeep), ParameterError);
  EXPECT_TRUE(params.enabled);
}

TEST(ParameterMap, UnknownKeySuggestsTheNearest) {
  Params params;
  const auto error = [&](const char* key) {
    return errorOf([&] { fromMap(params, {{key, 1.0}}, MissingKeys::kKeep); });
  };
  EXPECT_EQ(error("ukf.alpah"), "ukf.alpah: unknown parameter, did you mean ukf.alpha?");
  EXPECT_EQ(error("range"), "range: unknown parameter, did you mean range_m?");
  EXPECT_EQ(error("alpha"), "alpha: unknown parameter, did you mean ukf.alpha?");
  EXPECT_EQ(error("quite_another_thing"), "quite_another_thing: unknown parameter");
  EXPECT_EQ(error("ukf"), "ukf: is a group of parameters, such as ukf.alpha");
}

TEST(ParameterMap, KeyErrorsCarryTheKey) {
  Params params;
  try {
    fromMap(params, {{"ukf.order", false}}, MissingKeys::kKeep);
    FAIL() << "no error";
  } catch (const ParameterKeyError& error) {
    EXPECT_EQ(error.key(), "ukf.order");
  }
}

TEST(SetParameter, ReadsTextByTheFieldsType) {
  Params params;
  setParameter(params, "enabled=false");
  setParameter(params, "ukf.order = -3");
  setParameter(params, "ukf.alpha=1e-3");
  setParameter(params, "source=a=b");
  setParameter(params, "offsets_m=[1, 2.5,-3e2]");
  setParameter(params, "range_m=inf");
  EXPECT_FALSE(params.enabled);
  EXPECT_EQ(params.ukf.order, -3);
  EXPECT_EQ(params.ukf.alpha, 1e-3);
  EXPECT_EQ(params.source, "a=b");
  EXPECT_EQ(params.offsets_m, (std::vector<double>{1.0, 2.5, -300.0}));
  EXPECT_TRUE(std::isinf(params.range_m));
  setParameter(params, "offsets_m=[]");
  setParameter(params, "source=");
  EXPECT_TRUE(params.offsets_m.empty());
  EXPECT_TRUE(params.source.empty());
}

TEST(SetParameter, RefusesWhatItCannotReadWhole) {
  Params params;
  for (const char* assignment : {"enabled=1",
                                 "enabled=",
                                 "ukf.order=3.0",
                                 "ukf.order=3x",
                                 "ukf.order=",
                                 "ukf.order=99999999999",
                                 "ukf.order=0x10",
                                 "range_m=1.0m",
                                 "range_m=",
                                 "range_m=nan",
                                 "range_m=1e999",
                                 "range_m=1 2",
                                 "range_m=0x10",
                                 "range_m=1,5",
                                 "offsets_m=1",
                                 "offsets_m=[1,]",
                                 "offsets_m=[1 2]",
                                 "offsets_m=[1,x]",
                                 "offsets_m=[",
                                 "range_m",
                                 "=3",
                                 ""}) {
    EXPECT_THROW(setParameter(params, assignment), ParameterError) << assignment;
  }
  EXPECT_EQ(toMap(params), toMap(Params()));
  EXPECT_EQ(errorOf([&] { setParameter(params, "ukf.order=two"); }), "ukf.order: must be an int, not \"two\"");
  EXPECT_EQ(errorOf([&] { setParameter(params, "range_m"); }), "\"range_m\": must be key=value");
}

TEST(FormatDouble, IsShortAndReadsBack) {
  EXPECT_EQ(formatDouble(0.0), "0.0");
  EXPECT_EQ(formatDouble(1.0), "1.0");
  EXPECT_EQ(formatDouble(0.1), "0.1");
  EXPECT_EQ(formatDouble(-1750.0), "-1750.0");
  EXPECT_EQ(formatDouble(100000.0), "100000.0");
  EXPECT_EQ(formatDouble(999.99), "999.99");
  EXPECT_EQ(formatDouble(1e-7), "1.0e-07");
  EXPECT_EQ(formatDouble(2.5e30), "2.5e+30");
  for (const double value : {1.0 / 3.0, 0.1 + 0.2, -1e300 / 7.0, std::numeric_limits<double>::denorm_min(),
                             std::numeric_limits<double>::max(), -std::numeric_limits<double>::infinity()}) {
    double read_back = 0.0;
    ASSERT_TRUE(parseDouble(formatDouble(value), read_back)) << formatDouble(value);
    EXPECT_EQ(read_back, value);
  }
}

}  // namespace
}  // namespace fail_aware::parameter_map_test
