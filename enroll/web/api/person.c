#include "enroll/web/api/person.h"

#include <inttypes.h>

#include "enroll/web/daemon/json_text.h"

int web__api_person_read(sd_bus_message *reply, struct web_api_person *out)
{
    out->cards = NULL;
    return sd_bus_message_read(reply, "(sxxxu)", &out->name, &out->enrolled_s, &out->valid_from_s,
                               &out->valid_until_s, &out->templates);
}

void web__api_person_write(FILE *out, const struct web_last_seen *seen,
                           const struct web_api_person *person, const char *remark)
{
    const int64_t seen_s = web_last_seen_of(seen, person->name);
    (void)fputs("{\"name\":", out);
    web_json_text(out, person->name);
    if (person->cards) {
        (void)fputs(person->cards, out);
    }
    (void)fprintf(out,
                  ",\"enrolled_s\":%" PRId64 ",\"valid_from_s\":%" PRId64
                  ",\"valid_until_s\":%" PRId64 ",\"templates\":%" PRIu32 ",\"last_seen_s\":",
                  person->enrolled_s, person->valid_from_s, person->valid_until_s,
                  person->templates);
    if (seen_s > 0) {
        (void)fprintf(out, "%" PRId64, seen_s);
    } else {
        (void)fputs("null", out);
    }
    if (*remark) {
        (void)fputs(",\"remark\":", out);
        web_json_text(out, remark);
    }
    (void)fputc('}', out);
}
