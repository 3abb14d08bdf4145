// MAT files that something has happened to: none may be read as other numbers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/temp_dir.h"
#include "tests/trace/mat_bytes.h"
#include "trace/mat.h"

namespace dynoproof::trace {
namespace {

using test::Doubles5;
using test::Element5;
using test::Header5;
using test::Matrix4;
using test::Packed5;
using test::Plain5;
using test::Raw;
using test::Text4;
using test::Variable5;
using test::Wave;
using test::Words;
using ::testing::AnyOf;
using ::testing::HasSubstr;

class Damage : public ::testing::Test {
 protected:
  Result<Record> Read(const std::string& bytes) { return ReadMat(dir_.Write("x.mat", bytes)); }
  std::string Fault(const std::string& bytes) {
    const Result<Record> record = Read(bytes);
    if (record.ok()) return "it was read";
    EXPECT_EQ(record.failure().exit_code, 2);
    EXPECT_THAT(record.failure().signal, HasSubstr("x.mat"));
    return record.failure().message;
  }

  struct Tally {
    int refused = 0, unchanged = 0, wrong = 0;
  };
  /// Turns every bit of the file, one at a time.
  Tally TurnEveryBit(const std::string& whole) {
    const Result<Record> right = Read(whole);
    EXPECT_TRUE(right.ok());
    Tally tally;
    for (std::size_t bit = 0; right.ok() && bit < 8 * whole.size(); ++bit) {
      std::string damaged = whole;
      damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
      const Result<Record> record = Read(damaged);
      if (!record.ok()) {
        EXPECT_EQ(record.failure().exit_code, 2) << "bit " << bit;
        ++tally.refused;
        continue;
      }
      bool same = record->columns.size() == right->columns.size() && record->left_out == right->left_out;
      for (std::size_t k = 0; same && k < record->columns.size(); ++k)
        same =
            record->columns[k].name == right->columns[k].name && record->columns[k].values == right->columns[k].values;
      same ? ++tally.unchanged : ++tally.wrong;
      if (!same) wrong_bits_.push_back(bit);
    }
    return tally;
  }

  test::TempDir dir_;
  std::vector<std::size_t> wrong_bits_;
};

TEST_F(Damage, NoBitOfACompressedFileGivesOtherNumbers) {
  std::string whole = Header5();
  for (const char* name : {"t", "T_shaft", "omega_1"})
    whole += Packed5(Plain5(Doubles5(name, Wave(12, 0.1 * name[0]))));
  const Tally tally = TurnEveryBit(whole);
  EXPECT_EQ(tally.wrong, 0) << ::testing::PrintToString(wrong_bits_);
  EXPECT_GT(tally.refused, 2000);
  // The text of the header, what stands for its subsystem, and bits between the end of a stream and its checksum.
  EXPECT_LT(tally.unchanged, 8 * 124 + 3 * 8);
  RecordProperty("refused", tally.refused);
  RecordProperty("unchanged", tally.unchanged);
}

TEST_F(Damage, InAPlainFileOnlyNamesAndNumbersCanChangeUnseen) {
  const Variable5 variable = Doubles5("torque", Wave(8));
  const std::string whole = Header5() + Plain5(variable);
  const Tally tally = TurnEveryBit(whole);
  // Behind the header: tag 8, class 16, extents 16, name 16, then the numbers with their tag. A name may become
  // shorter.
  const std::size_t name = 128 + 8 + 16 + 16 + 4, numbers = 128 + 8 + 16 + 16 + 16 + 8;
  for (const std::size_t bit : wrong_bits_) {
    const std::size_t at = bit / 8;
    const bool is_class = at >= 128 + 16 && at < 128 + 18;  // text, struct or cell instead of numbers: left out
    EXPECT_TRUE((at >= name && at < name + 10) || at >= numbers || is_class) << "bit " << bit;
  }
  RecordProperty("wrong", tally.wrong);
}

TEST_F(Damage, NoHeaderOfAV4MatrixCanChangeUnseen) {
  const std::string whole = Matrix4(0, 8, 1, "torque", Raw(Wave(8))) + Matrix4(0, 8, 1, "t", Raw(Wave(8)));
  TurnEveryBit(whole);
  for (const std::size_t bit : wrong_bits_) {
    const std::size_t at = bit / 8, second = 20 + 7 + 64;
    const std::size_t inside = at < second ? at : at - second;
    // But for the kind: numbers that have become text are left out.
    EXPECT_TRUE(inside >= 20 || (inside == 0 && bit % 8 == 0)) << "bit " << bit << ": the header of a matrix";
  }
}

TEST_F(Damage, NumbersThatAreNotThereAreNeverRead) {
  const std::vector<double> ten = Wave(10), fifty = Wave(50);
  Variable5 few = Doubles5("x", ten);
  few.extents = {50, 1};
  EXPECT_THAT(Fault(Header5() + Plain5(Doubles5("t", fifty)) + Plain5(few)), HasSubstr("do not make 50 x 1 values"));
  Variable5 many = Doubles5("x", fifty);
  many.extents = {10, 1};
  EXPECT_THAT(Fault(Header5() + Plain5(many)), HasSubstr("do not make 10 x 1 values"));

  // The tag of the numbers promises what the next variable holds.
  std::string inside = test::Inside5(Doubles5("x", ten));
  inside.replace(inside.size() - 84, 4, Words({400}));
  EXPECT_THAT(Fault(Header5() + Element5(14, inside) + Plain5(Doubles5("t", fifty))),
              HasSubstr("real part has 400 bytes, of which 80 are there"));
}

TEST_F(Damage, ExtentsThatNoFileCanHoldAreRefusedBeforeAnythingIsAllocated) {
  Variable5 huge = Doubles5("x", Wave(4));
  for (const std::vector<std::uint32_t>& extents :
       {std::vector<std::uint32_t>{0x7fffffff, 0x7fffffff}, {0x7fffffff, 0x7fffffff, 0x7fffffff}, {0xffffffff, 1}}) {
    huge.extents = extents;
    EXPECT_THAT(Fault(Header5() + Plain5(huge)),
                AnyOf(HasSubstr("do not make"), HasSubstr("beyond all bounds"), HasSubstr("negative")))
        << extents[0];
  }
  for (const std::uint32_t rows : {0xffffffffU, 0x20000000U, 9U})
    EXPECT_THAT(Fault(Matrix4(0, rows, 0xffffffff, "x", Raw(Wave(8)))), HasSubstr("of which the file can hold 8"));
  EXPECT_THAT(Fault(Matrix4(0, 3, 1, "x", Raw(Wave(8)))), HasSubstr("the matrix at byte 46"));
}

TEST_F(Damage, ACompressedVariableIsUnpackedWholeAndOnce) {
  const std::string plain = Plain5(Doubles5("x", Wave(50)));
  EXPECT_TRUE(Read(Header5() + Packed5(plain)).ok());
  EXPECT_THAT(Fault(Header5() + Packed5(plain, 40)), HasSubstr("it ends too early"));
  EXPECT_THAT(Fault(Header5() + Packed5(plain, 2)), HasSubstr("it ends too early")) << "the checksum is cut";
  EXPECT_THAT(Fault(Header5() + Packed5(plain + "12345678")), HasSubstr("more than its"));
  EXPECT_THAT(Fault(Header5() + Packed5(plain.substr(0, plain.size() - 8))), HasSubstr("8 bytes less"));
  std::string followed = Packed5(plain) + "12345678";
  followed.replace(4, 4, Words({static_cast<std::uint32_t>(followed.size() - 8)}));
  EXPECT_THAT(Fault(Header5() + followed), HasSubstr("8 bytes behind its end"));
  EXPECT_THAT(Fault(Header5() + Packed5(Packed5(plain))), HasSubstr("something else than a variable"));
}

TEST_F(Damage, WhatUnpacksToGigabytesIsRefusedBeforehand) {
  std::string bomb = Words({14, 0x7ffffff0}) + std::string(3'000'000, '\0');
  const std::string file = Header5() + Packed5(bomb);
  EXPECT_THAT(Fault(file), HasSubstr("packed ones cannot hold")) << file.size();
}

TEST_F(Damage, PartsAreOfTheTypeThatTheirPlaceAsksFor) {
  Variable5 x = Doubles5("x", Wave(8));
  x.data_type = 13;
  EXPECT_THAT(Fault(Header5() + Plain5(x)), HasSubstr("type 13, which class 6 does not have"))
      << "as large as a double";
  x.data_type = 9;
  x.class_type = 7;
  EXPECT_THAT(Fault(Header5() + Plain5(x)), HasSubstr("which class 7 does not have"));
  x.class_type = 19;
  EXPECT_THAT(Fault(Header5() + Plain5(x)), HasSubstr("class 19 is unknown"));
  x.class_type = 0x806;  // complex, but without an imaginary part
  EXPECT_THAT(Fault(Header5() + Plain5(x)), HasSubstr("imaginary part is not whole"));
  x.class_type = 6;
  x.behind = Element5(9, Raw(Wave(8)));
  EXPECT_THAT(Fault(Header5() + Plain5(x)), HasSubstr("something stands behind its values"));
  EXPECT_THAT(Fault(Header5() + Element5(9, Raw(Wave(8)))), HasSubstr("type 9, no variable"));
  EXPECT_THAT(Fault(Header5() + Plain5(Doubles5("x", Wave(8))) + "abc"), HasSubstr("has no whole tag"));
}

TEST_F(Damage, ShortPartsAndFewerBytesANumberAreRead) {
  // As MATLAB writes it: names of up to four letters inside the tag, whole numbers in fewer bytes.
  const std::string name = Words({1U << 16 | 1}) + std::string("x\0\0\0", 4);
  const std::string inside = Element5(6, Words({6, 0})) + Element5(5, Words({5, 1})) + name +
                             Element5(4, Raw(std::vector<std::uint16_t>{1, 2, 3, 40000, 5}));
  const Result<Record> record = Read(Header5() + Packed5(Element5(14, inside)));
  ASSERT_TRUE(record.ok()) << record.failure().ToString();
  ASSERT_EQ(record->Names(), std::vector<std::string>{"x"});
  EXPECT_THAT(record->columns[0].values, ::testing::ElementsAre(1, 2, 3, 40000, 5));
}

TEST_F(Damage, ANameOfAnyBytesCanBeShown) {
  const std::string latin1 =
      "Dr\xfc"
      "ck";
  const std::string packed = Header5() + Packed5(Plain5(Doubles5(latin1, Wave(8))));
  const std::string v4 = Matrix4(0, 8, 1, latin1, Raw(Wave(8)));
  for (const std::string& bytes : {packed, v4}) {
    const Result<Record> record = Read(bytes);
    ASSERT_TRUE(record.ok()) << record.failure().ToString();
    EXPECT_EQ(record->Names(), std::vector<std::string>{"Drück"});
  }
  EXPECT_THAT(Read(Matrix4(0, 8, 1, "x\n\x1b[2J", Raw(Wave(8))))->Names(), ::testing::ElementsAre("x\\x0a\\x1b[2J"));
  Variable5 few = Doubles5(latin1, Wave(8));
  few.extents = {50, 1};
  EXPECT_THAT(Fault(Header5() + Plain5(few)), HasSubstr("Drück"));
  few.extents = {8, 1};
  few.class_type = 4;
  few.data_type = 4;
  few.data = std::string(16, 'a');
  EXPECT_THAT(Fault(Header5() + Plain5(few)), HasSubstr("variable \"Drück\" is text"));
}

TEST_F(Damage, TheTextsOfAResultMayBeAnyNumbers) {
  // The same texts as doubles, one of them no letter.
  std::vector<double> letters = {'t', 'i', 'm', 'e', 1e300, std::nan(""), -1.0, 0.0};
  const auto with = [&](const std::string& name) {
    return Text4("Aclass", {"Atrajectory", "1.1", "", "binTrans"}, false) + name +
           Matrix4(20, 4, 2, "dataInfo", Raw(std::vector<std::int32_t>{0, 1, 0, -1, 2, 2, 0, -1})) +
           Matrix4(0, 1, 2, "data_1", Raw(std::vector<double>{0, 1})) +
           Matrix4(0, 2, 3, "data_2", Raw(std::vector<double>{0, 0.5, 1, 1, 2, 3}));
  };
  const Result<Record> record = Read(with(Matrix4(1, 4, 2, "name", Raw(letters))));
  ASSERT_TRUE(record.ok()) << record.failure().ToString();
  EXPECT_EQ(record->Names(), (std::vector<std::string>{"time", "???"}));
}

TEST_F(Damage, TheOtherByteOrderIsRead) {
  std::string word;
  const auto put = [&](std::uint64_t value, int bytes) {
    for (int i = bytes - 1; i >= 0; --i) word += static_cast<char>(value >> 8 * i & 0xff);
  };
  for (const std::uint32_t value : {1000U, 2U, 1U, 0U, 2U}) put(value, 4);
  word += std::string("x\0", 2);
  put(0x3ff0000000000000, 8);
  put(0xc000000000000000, 8);
  const Result<Record> record = Read(word);
  ASSERT_TRUE(record.ok()) << record.failure().ToString();
  EXPECT_THAT(record->columns[0].values, ::testing::ElementsAre(1.0, -2.0));
  word[3] = static_cast<char>(0xd0), word[2] = 7;  // 2000: the numbers of a VAX
  EXPECT_THAT(Fault(word), HasSubstr("is no MAT file"));
}

}  // namespace
}  // namespace dynoproof::trace
