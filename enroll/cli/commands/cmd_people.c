/* list and remove: list the people of the gallery, and delete one of them. */
#include "enroll/cli/commands/commands.h"

#include <errno.h>
#include <inttypes.h>

#include "drivers/terminal/columns.h"
#include "enroll/cli/arguments/when.h"
#include "enroll/cli/text/report.h"
#include "enroll/cli/text/same_names.h"
#include "firmware/contract/contract.h"

struct person {
    const char *name; /* points into the reply */
    int64_t enrolled_s, valid_from_s, valid_until_s;
    uint32_t templates;
};

/* Returns 1 and fills in *person, 0 if there are no more people, or a negative errno. */
static int next_person(sd_bus_message *reply, struct person *person)
{
    return sd_bus_message_read(reply, "(sxxxu)", &person->name, &person->enrolled_s,
                               &person->valid_from_s, &person->valid_until_s, &person->templates);
}

static json_t *to_json(const struct person *person)
{
    return json_pack("{s:s, s:I, s:I, s:I, s:I}", "person", person->name, "enrolled",
                     (json_int_t)person->enrolled_s, "valid_from", (json_int_t)person->valid_from_s,
                     "valid_until", (json_int_t)person->valid_until_s, "templates",
                     (json_int_t)person->templates);
}

static enum cli_exit list_json(sd_bus_message *reply, struct cli_fault *fault)
{
    json_t *people = json_array();
    struct person person;
    int r;

    while ((r = next_person(reply, &person)) > 0) {
        if (json_array_append_new(people, to_json(&person)) < 0) {
            r = -ENOMEM;
            break;
        }
    }
    if (r < 0) {
        json_decref(people);
        return cli_daemon_bad_reply(r, ISO_CONTRACT_LIST_PEOPLE, fault);
    }
    return cli_report_json(json_pack("{s:o}", "people", people));
}

/* Measures the width of the column of names: that of the longest name, but at least 24. Then goes
 * back to the first person of the reply. */
static int measure_names(sd_bus_message *reply, size_t *columns)
{
    struct person person;
    int r;

    *columns = 24;
    while ((r = next_person(reply, &person)) > 0) {
        const size_t own = iso_columns_of(person.name);
        *columns = own > *columns ? own : *columns;
    }
    if (r >= 0) {
        r = sd_bus_message_rewind(reply, 1);
    }
    return r < 0 ? r : sd_bus_message_enter_container(reply, 'a', "(sxxxu)");
}

static void print_person(const struct person *person, size_t columns)
{
    char enrolled[CLI_WHEN_SIZE], from[CLI_WHEN_SIZE], until[CLI_WHEN_SIZE];

    cli_when_format(person->enrolled_s, enrolled);
    cli_when_format(person->valid_from_s, from);
    cli_when_format(person->valid_until_s, until);
    iso_columns_print(stdout, person->name, columns);
    printf(" %-16s  %-16s  %-16s  %" PRIu32 "\n", enrolled, from, until, person->templates);
}

static enum cli_exit list_text(sd_bus_message *reply, struct cli_fault *fault)
{
    struct cli_same_names names = {0};
    struct person person;
    unsigned count = 0;
    size_t columns;
    int r = measure_names(reply, &columns);

    while (r >= 0 && (r = next_person(reply, &person)) > 0) {
        if (count++ == 0) {
            printf("%-*s %-16s  %-16s  %-16s  %s\n", (int)columns, "person", "enrolled",
                   "valid from", "valid until", "templates");
        }
        print_person(&person, columns);
        cli_same_names_add(&names, person.name);
    }
    cli_same_names_print(&names, stderr);
    cli_same_names_done(&names);
    if (r < 0) {
        return cli_daemon_bad_reply(r, ISO_CONTRACT_LIST_PEOPLE, fault);
    }
    if (count == 0) {
        puts("nobody is enrolled");
    }
    return CLI_EXIT_OK;
}

enum cli_exit cli_list(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                       struct cli_fault *fault)
{
    sd_bus_message *reply = NULL;
    enum cli_exit exit = cli_daemon_call(daemon, ISO_CONTRACT_LIST_PEOPLE, &reply, fault);

    if (exit) {
        return exit;
    }
    const int r = sd_bus_message_enter_container(reply, 'a', "(sxxxu)");
    if (r < 0) {
        exit = cli_daemon_bad_reply(r, ISO_CONTRACT_LIST_PEOPLE, fault);
    } else {
        exit = arguments->json ? list_json(reply, fault) : list_text(reply, fault);
    }
    sd_bus_message_unref(reply);
    return exit;
}

enum cli_exit cli_remove(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                         struct cli_fault *fault)
{
    sd_bus_message *call = NULL;
    enum cli_exit exit = cli_daemon_message(daemon, ISO_CONTRACT_DELETE_PERSON, &call, fault);

    if (exit) {
        return exit;
    }
    const int r = sd_bus_message_append(call, "s", arguments->person);
    if (r < 0) {
        sd_bus_message_unref(call);
        return cli_fault_set(fault, CLI_EXIT_USAGE, "invalid-name", "the name is not UTF-8");
    }
    exit = cli_daemon_send(daemon, call, NULL, fault);
    if (exit) {
        return exit;
    }
    if (arguments->json) {
        return cli_report_json(json_pack("{s:s}", "removed", arguments->person));
    }
    printf("%s is removed.\n", arguments->person);
    return CLI_EXIT_OK;
}
