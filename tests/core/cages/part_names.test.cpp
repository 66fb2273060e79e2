#include "mesh/part_names.hpp"

#include <catch2/catch.hpp>

#include <string>

using namespace cagecast;
using namespace cagecast::cages;

TEST_CASE("patterns match whole texts, whatever their case", "[cages][names]") {
  for (const auto& [text, pattern] : std::vector<std::pair<const char*, const char*>>{{"Eye", "eye"},
                                                                                      {"eyeball", "eye*"},
                                                                                      {"anything", "*"},
                                                                                      {"", "*"},
                                                                                      {"left eye 2", "*eye*"},
                                                                                      {"abcbcd", "a*bcd"},
                                                                                      {"tooth", "t??th"}})
    CHECK(matches(text, pattern));
  for (const auto& [text, pattern] :
       std::vector<std::pair<const char*, const char*>>{{"eyeball", "eye"}, {"", "?"}, {"abcbce", "a*bcd"}})
    CHECK_FALSE(matches(text, pattern));
}

TEST_CASE("many stars take no longer than the lengths multiplied", "[cages][names]") {
  const std::string text(20000, 'a');
  std::string pattern;
  for (int i = 0; i < 500; ++i) pattern += "*a";
  CHECK(matches(text, pattern));
  CHECK_FALSE(matches(text, pattern + "b"));
}

TEST_CASE("words begin at capitals and end at signs and digits", "[cages][names]") {
  using Words = std::vector<std::string_view>;
  CHECK(wordsOf("Wolf3D_EyeLeft/l-eye") == Words{"Wolf", "D", "Eye", "Left", "l", "eye"});
  CHECK(wordsOf("HTMLEye") == Words{"HTMLEye"});
  CHECK(wordsOf("  ").empty());
}

TEST_CASE("the default exclusions know eyes, teeth and wheels, not skin", "[cages][names]") {
  for (const char* name :
       {"l-eye/l-eye", "EyeLeft", "Wolf3D_Teeth", "upper-teeth/enamel", "Eyelashes", "FaceBrow_00", "head/tongue.001",
        "window.002", "wheel_backLeft.007/", "carTire.016", "steering-wheel", "node/mesh/EyeIris", "Hair_Back",
        "afro01", "Human.bob01/bob01", "ponytail01", "Human.high-poly/high-poly"}) {
    CAPTURE(name);
    CHECK(excludedByName({name})[0]);
  }
  for (const char* name : {"skin", "eyelid", "body.007/paintRed", "head", "Chair", "Wolf3D_Outfit_Top", "bumpers",
                           "King_Legs/DarkBrown", "Shirt/LightBlue", "Bob/skin", "body_high-poly"}) {
    CAPTURE(name);
    CHECK_FALSE(excludedByName({name})[0]);
  }
}

TEST_CASE("words of vehicles count on vehicles", "[cages][names]") {
  for (const char* name : {"lightFront.002", "Main_Light", "Young Asian Female LIGHT", "Seat", "rim"}) {
    CAPTURE(name);
    CHECK(excludedByName({"wheel_backLeft", name}) == std::vector<bool>{true, true});
    CHECK(excludedByName({"skin", name}) == std::vector<bool>{false, false});
  }
}
