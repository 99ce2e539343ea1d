/* For a build without toml++ or without a C++ compiler. */
#include "enroll/policy_reader/reader_input.h"

json_t *reader_toml(const char *text, size_t size, struct reader_line *line)
{
    (void)text, (void)size;
    return reader_refuse(line, "this build cannot read TOML: write the policy in JSON");
}
