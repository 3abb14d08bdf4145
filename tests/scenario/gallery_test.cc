// The gallery of wrong scenario files: tests/scenario/wrong/gallery.toml spoils wrong/base.toml in one place after the
// other and says what Prepare() must answer, word for word: file, line, column, what was seen, what instead.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <cctype>
#include <memory>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "base/text.h"
#include "experiment/prepare.h"
#include "tests/support/registry.h"
#include "tests/support/temp_dir.h"

namespace dynoproof {
namespace {

constexpr const char* kBase = "tests/scenario/wrong/base.toml";
constexpr const char* kGallery = "tests/scenario/wrong/gallery.toml";

struct Case {
  std::string name, part, says;
  std::vector<std::pair<std::string, std::string>> edits;
  std::vector<std::string> overrides;
};

void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

std::vector<Case> ReadGallery() {
  std::vector<Case> cases;
  const toml::table gallery = toml::parse_file(kGallery);
  for (const toml::node& node : *gallery["case"].as_array()) {
    const toml::table& table = *node.as_table();
    Case one{table["name"].value_or(""), table["part"].value_or(""), table["says"].value_or(""), {}, {}};
    if (const toml::array* edits = table["edits"].as_array()) {
      for (const toml::node& edit : *edits) {
        const toml::array& pair = *edit.as_array();
        one.edits.emplace_back(pair[0].value_or(""), pair[1].value_or(""));
      }
    }
    if (const toml::array* overrides = table["set"].as_array()) {
      for (const toml::node& text : *overrides) one.overrides.push_back(text.value_or(""));
    }
    cases.push_back(std::move(one));
  }
  return cases;
}

/// base.toml with the edits made; a text that does not stand there exactly once is a fault of the gallery.
std::string Spoiled(const Case& one) {
  std::string text = ReadTextFile(kBase).value();
  for (const auto& [find, put] : one.edits) {
    const std::size_t at = text.find(find);
    if (at == std::string::npos || text.find(find, at + 1) != std::string::npos) {
      ADD_FAILURE() << "stands not once in the base: " << find;
      return text;
    }
    text.replace(at, find.size(), put);
  }
  return text;
}

/// What Prepare() says of a text, with the temporary folder cut off the places.
std::string SaidOf(const std::string& text, const Case& one) {
  const test::TempDir folder;
  const std::string file = folder.Write("case.toml", text);
  if (!one.part.empty()) folder.Write("_part.toml", one.part);
  Diagnostics diagnostics;
  PrepareOptions options;
  options.overrides = one.overrides;
  const std::unique_ptr<Prepared> prepared = Prepare(file, options, testing::FullRegistry(), diagnostics);
  EXPECT_EQ(prepared == nullptr, diagnostics.has_errors());
  std::string said = diagnostics.Format();
  const std::string prefix = folder.path().string() + "/";
  for (std::size_t at = said.find(prefix); at != std::string::npos; at = said.find(prefix))
    said.erase(at, prefix.size());
  return said;
}

class Gallery : public ::testing::TestWithParam<Case> {};

TEST_P(Gallery, SaysWhereWhatAndWhatInstead) { EXPECT_EQ(SaidOf(Spoiled(GetParam()), GetParam()), GetParam().says); }

INSTANTIATE_TEST_SUITE_P(Wrong, Gallery, ::testing::ValuesIn(ReadGallery()), [](const auto& one) {
  std::string name;
  for (const char c : one.param.name) name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return name;
});

TEST(GalleryItself, StartsFromAValidFileAndIsLarge) {
  EXPECT_EQ(SaidOf(ReadTextFile(kBase).value(), {}), "");
  EXPECT_GE(ReadGallery().size(), 50u);
}

/// What there is grows with every plugin, so that the whole line is not pinned.
TEST(GalleryItself, ListsThePlantsWhenNoneIsNamed) {
  const Case one{"", "", "", {{"type = \"drive_line\"\n", ""}}, {}};
  const std::string said = SaidOf(Spoiled(one), one);
  EXPECT_THAT(said, ::testing::HasSubstr("case.toml:13:1: error: plant needs a \"type\"\n"));
  EXPECT_THAT(said, ::testing::ContainsRegex("known: .*drive_line"));
}

/// A case whose answer names no place is one that a user cannot mend.
TEST(GalleryItself, NamesAPlaceInEveryAnswer) {
  for (const Case& one : ReadGallery()) {
    const bool placed =
        one.says.find("case.toml:") == 0 || one.says.find("_part.toml:") == 0 || one.says.find("--set:") == 0;
    EXPECT_TRUE(placed) << one.name;
    EXPECT_NE(one.says.find("error: "), std::string::npos) << one.name;
    EXPECT_NE(one.says.find(" | "), std::string::npos) << one.name << ": the line is not shown";
  }
}

}  // namespace
}  // namespace dynoproof
