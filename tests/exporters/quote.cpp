// Words of strangers in the languages of other codes.
#include "exporters/quote.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace packmpi::exporters {
namespace {

/// The complaint about a name; "" if there is none.
template <class Quote>
std::string complaint(Quote quote, const std::string& name) {
  try {
    (void)quote(name);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    return error.what();
  }
  return "";
}

TEST(Quote, CommentsAreOneLineOfWords) {
  EXPECT_EQ(comment("a-b_1.hdf (x = 2; y), é"), "a-b_1.hdf (x = 2; y), é");
  EXPECT_EQ(comment("a\nimport os\r#\\"), "a?import os???");
  EXPECT_EQ(comment("\"\"\"'''&$`<%{}?"), std::string(14, '?'));
}

TEST(Quote, StringsOfPythonAndCpp) {
  EXPECT_EQ(python_string("a b.txt"), "\"a b.txt\"");
  EXPECT_EQ(python_string("\"'\\ä?"), "\"\\\"'\\\\ä?\"");
  EXPECT_EQ(cpp_string("\"'\\ä?"
                       "?/"),
            "\"\\\"'\\\\ä\\?\\?/\"");
}

TEST(Quote, WhatALanguageCannotSayIsRefused) {
  EXPECT_EQ(lammps_word("a b#c.data"), "\"'a b#c.data'\"");
  for (const char* name : {"a'b", "a\"b", "a$b", "a&b", "é"}) EXPECT_NE(complaint(lammps_word, name), "") << name;
  EXPECT_EQ(liggghts_word("é a.data"), "\"'é a.data'\"");
  EXPECT_EQ(lethe_file("a b.txt"), "a b.txt");
  for (const char* name : {"a,b", "a#b", "a\\b", "a|b"}) EXPECT_NE(complaint(lethe_file, name), "") << name;
  const auto check = [](const std::string& name) { return check_file_name(name), 0; };
  for (const char* name : {"", " a", "a ", "a\nb", "a\x1b", "a\xff", "a\x7f"}) {
    EXPECT_NE(complaint(check, name), "") << name;
  }
  EXPECT_EQ(complaint(check, "größer als 1 m.txt"), "");
}

}  // namespace
}  // namespace packmpi::exporters
