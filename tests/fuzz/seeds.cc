// Writes the binary files of the corpus: MAT and HDF5 files of every version and form, small.
//   fuzz_seeds FOLDER
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tests/trace/hdf5_file.h"
#include "tests/trace/mat_bytes.h"
#include "tests/trace/sample_trace.h"
#include "trace/trace_io.h"

namespace {

using namespace dynoproof;        // NOLINT: a program of one file
using namespace dynoproof::test;  // NOLINT
namespace fs = std::filesystem;

void Write(const fs::path& file, const std::string& bytes) { std::ofstream(file, std::ios::binary) << bytes; }

void Mat(const fs::path& folder) {
  const std::vector<double> wave = Wave(6);
  Write(folder / "v5_plain", Header5() + Plain5(Doubles5("t", Wave(6, 1.0))) + Plain5(Doubles5("torque", wave)));
  Write(folder / "v5_packed", Header5() + Packed5(Plain5(Doubles5("t", wave))) + Packed5(Plain5(Doubles5("w", wave))));
  Variable5 matrix = Doubles5("m", wave);
  matrix.extents = {3, 2};
  Variable5 few = {"n", {3, 1}, Raw(std::vector<std::uint16_t>{1, 2, 3}), 4};
  Write(folder / "v5_matrix", Header5() + Plain5(matrix) + Plain5(few));
  Variable5 complex = Doubles5("z", wave);
  complex.class_type = 0x806;
  complex.behind = Element5(9, Raw(wave));
  Write(folder / "v5_left_out", Header5() + Plain5(complex) + Plain5(Doubles5("x", wave)));
  Write(folder / "v4", Matrix4(0, 6, 1, "t", Raw(wave)) + Matrix4(0, 3, 2, "x", Raw(wave)));
  Write(folder / "v4_result",
        Text4("Aclass", {"Atrajectory", "1.1", "", "binTrans"}, false) + Text4("name", {"time", "w"}, true) +
            Text4("description", {"s", "rad/s"}, true) +
            Matrix4(20, 4, 2, "dataInfo", Raw(std::vector<std::int32_t>{0, 1, 0, -1, 2, 2, 0, -1})) +
            Matrix4(0, 1, 2, "data_1", Raw(std::vector<double>{0, 1})) +
            Matrix4(0, 2, 3, "data_2", Raw(std::vector<double>{0, 1, 0.5, 2, 1, 3})));
  const fs::path v73 = folder / "v73";
  {
    Hdf5File file(v73, 512);
    file.Numbers("t", {0, 1, 2, 3}, {.shape = {1, 4}});
    file.Numbers("x", {1, 2, 3, 4}, {.shape = {1, 4}, .chunk = {1, 4}, .deflate = true});
    file.Text("x", "MATLAB_class", "double");
  }
  std::fstream block(v73, std::ios::in | std::ios::out | std::ios::binary);
  std::string header = Header5();
  header.replace(124, 4, std::string("\x00\x02IM", 4));
  block << header;
}

void Hdf5(const fs::path& folder) {
  trace::Trace trace = trace::SampleTrace(20);
  if (trace::WriteTrace(folder / "trace", trace) ||
      trace::WriteTrace(folder / "trace_packed", trace, {.deflate_level = 1}))
    std::exit(1);
  {
    Hdf5File file(folder / "foreign");
    file.Numbers("time", {0, 1, 2});
    file.Text("time", "unit", "ms");
    file.Group("signals");
    file.Numbers("signals/x", {1, 2, 3}, {.type = H5T_IEEE_F32BE});
    file.Text("signals/x", "unit", "rad/s", true);
  }
  Hdf5File file(folder / "other_layout");
  file.Group("bench");
  file.Numbers("bench/t", {0, 1, 2, 3}, {.chunk = {2}, .deflate = true});
  file.Numbers("bench/matrix", {1, 2, 3, 4, 5, 6, 7, 8}, {.shape = {4, 2}, .type = H5T_STD_I16LE});
  file.Number("bench/matrix", "scale_factor", {0.5});
  file.Number("bench/matrix", "_FillValue", {-1}, H5T_STD_I16LE);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: fuzz_seeds FOLDER\n");
    return 2;
  }
  const fs::path folder = argv[1];
  for (const char* name : {"mat", "hdf5"}) fs::create_directories(folder / name);
  Mat(folder / "mat");
  Hdf5(folder / "hdf5");
}
