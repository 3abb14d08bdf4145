# Writes one source that holds several tests' sources: reading the same headers and making the same templates for each is most of
# the work of compiling them. Each file's unnamed namespace gets a name of its own, so that helpers of the same name stay apart;
# and a file that knows the tests' library alone finds it although another one has brought in what the tests share.
#   cmake -DOUTPUT=... "-DFILES=a_test.cc;b_test.cc" -P together.cmake
set(text "#include <gmock/gmock.h>\nnamespace dynoproof::testing {\nusing namespace ::testing;\n}\n")
foreach(file ${FILES})
  get_filename_component(name ${file} NAME_WE)
  file(READ ${file} source)
  string(REPLACE "namespace {" "namespace of_${name} {" source "${source}")
  string(APPEND text "#line 1 \"${file}\"\n${source}\n")
endforeach()
file(WRITE ${OUTPUT} "${text}")
