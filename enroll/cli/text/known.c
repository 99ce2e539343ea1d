#include "enroll/cli/text/known.h"

#include <inttypes.h>
#include <string.h>

#include "enroll/cli/arguments/when.h"
#include "firmware/contract/contract.h"

static int read_number(sd_bus_message *reply, const char *key, struct cli_known *out)
{
    const struct {
        const char *key;
        int64_t *value;
    } times[] = {
        {ISO_CONTRACT_ENROLLED, &out->enrolled_s},
        {ISO_CONTRACT_VALID_FROM, &out->valid_from_s},
        {ISO_CONTRACT_VALID_UNTIL, &out->valid_until_s},
    };

    for (size_t i = 0; i < sizeof times / sizeof *times; i++) {
        if (strcmp(key, times[i].key) == 0) {
            return sd_bus_message_read(reply, "v", "x", times[i].value);
        }
    }
    return strcmp(key, ISO_CONTRACT_TEMPLATES) == 0
               ? sd_bus_message_read(reply, "v", "u", &out->templates)
               : sd_bus_message_skip(reply, "v");
}

static int read_entry(sd_bus_message *reply, struct cli_known *out)
{
    const char *key, *person;
    int r = sd_bus_message_read_basic(reply, 's', &key);

    if (r < 0 || strcmp(key, ISO_CONTRACT_PERSON) != 0) {
        return r < 0 ? r : read_number(reply, key, out);
    }
    r = sd_bus_message_read(reply, "v", "s", &person);
    if (r >= 0) {
        (void)snprintf(out->person, sizeof out->person, "%s", person);
    }
    return r;
}

void cli_known_read(sd_bus_message *reply, struct cli_known *out)
{
    struct cli_known known = {.templates = 0};
    int r = sd_bus_message_enter_container(reply, 'a', "{sv}");

    while (r >= 0 && (r = sd_bus_message_enter_container(reply, 'e', "sv")) > 0) {
        r = read_entry(reply, &known);
        if (r >= 0) {
            r = sd_bus_message_exit_container(reply);
        }
    }
    if (r >= 0) {
        *out = known;
    }
}

void cli_known_say(const struct cli_known *known, int64_t now_s, FILE *out)
{
    char when[CLI_WHEN_SIZE];

    if (!known->person[0]) {
        return;
    }
    cli_when_format(known->enrolled_s, when);
    fprintf(out, "%s has %" PRIu32 " template%s since %s; this adds to %s.\n", known->person,
            known->templates, known->templates == 1 ? "" : "s", when,
            known->templates == 1 ? "it" : "them");
    if (known->valid_until_s && known->valid_until_s < now_s) {
        cli_when_format(known->valid_until_s, when);
        fprintf(out, "The door has not opened to %s since %s (see isotherm validity).\n",
                known->person, when);
    }
}
