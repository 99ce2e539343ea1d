#include "enroll/commands.h"

#include "enroll/report.h"
#include "enroll/state.h"

static void print_member(const char *name, const json_t *value)
{
    printf("%-18s ", name);
    if (json_is_string(value)) {
        puts(json_string_value(value));
    } else if (json_is_real(value)) {
        printf("%.4g\n", json_real_value(value));
    } else if (json_is_integer(value)) {
        printf("%" JSON_INTEGER_FORMAT "\n", json_integer_value(value));
    } else {
        puts(json_is_true(value) ? "yes" : json_is_false(value) ? "no" : "-");
    }
}

enum cli_exit cli_status(struct cli_door *door, const struct cli_arguments *arguments,
                         struct cli_fault *fault)
{
    json_t *state = NULL, *value;
    const char *name;
    const enum cli_exit exit = cli_state_fetch(door, &state, fault);

    if (exit) {
        return exit;
    }
    if (arguments->json) {
        return cli_report_json(state);
    }
    json_object_foreach(state, name, value)
    {
        print_member(name, value);
    }
    json_decref(state);
    return CLI_EXIT_OK;
}
