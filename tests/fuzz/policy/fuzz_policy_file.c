/* The readers of files for `isotherm policy import`: iCalendar, and TOML. What a calendar becomes
 * is a policy that the reader of documents accepts, or refuses for its tokens, its zone or the
 * number of periods alone: that reader is the next one that sees it. */
#include <stdlib.h>
#include <string.h>

#include "enroll/policy_reader/reader_input.h"
#include "tests/fuzz/fuzz.h"

static void expect_times(const json_t *document)
{
    fuzz_check(json_is_array(json_object_get(document, "special_day_groups")), "groups");
    size_t i;
    json_t *schedule;
    json_array_foreach(json_object_get(document, "schedules"), i, schedule)
    {
        fuzz_check(json_is_object(json_object_get(schedule, "weekly")), "hours");
        fuzz_check(json_is_string(json_object_get(schedule, "zone")), "a zone");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = (char *)fuzz_copy(data, size);
    struct reader_line line = {.text = ""};
    if (memchr(text, '\0', size) == NULL) { /* the program refuses these before */
        json_t *calendar = reader_ics(text, size, "UTC", 20261126, &line);
        fuzz_check(calendar || line.text[0], "a line");
        if (calendar) {
            expect_times(calendar);
        }
        json_decref(calendar);
        line.text[0] = '\0';
        json_t *table = reader_toml(text, size, &line);
        fuzz_check(table || line.text[0], "a line");
        fuzz_check(!strpbrk(line.text, "\n\r\033"), "one line");
        json_decref(table);
    }
    free(text);
    return 0;
}
