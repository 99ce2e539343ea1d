#include "enroll/cli/policy/policy_reader.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#include "drivers/file/file.h"
#include "enroll/cli/machine/child.h"

enum { FILE_MAX_BYTES = 1 << 20, OUTPUT_MAX_BYTES = 4 << 20 };

/* The format of the file by its ending, or NULL. */
static const char *format_of(const char *file)
{
    static const char *const formats[] = {"json", "toml", "ics"};
    const char *dot = strrchr(file, '.');

    for (size_t i = 0; dot && i < sizeof formats / sizeof *formats; i++) {
        if (strcasecmp(dot + 1, formats[i]) == 0) {
            return formats[i];
        }
    }
    return NULL;
}

static enum cli_exit open_file(const char *file, int *fd, struct cli_fault *fault)
{
    struct iso_fault why = {0};
    const int error = iso_file_open(file, O_RDONLY, FILE_MAX_BYTES, fd, &why);

    if (error == 0) {
        return CLI_EXIT_OK;
    }
    return cli_fault_set(fault, error == -ENOENT ? CLI_EXIT_NOT_FOUND : CLI_EXIT_FAULT,
                         error == -ENOENT ? "no-file" : "bad-file", "%s", why.text);
}

/* Reads what the program has printed. */
static enum cli_exit take_answer(const struct cli_child *child, const char *file, json_t **out,
                                 struct cli_fault *fault)
{
    if (child->exit != 0) {
        const int length = (int)strcspn(child->err, "\n");
        return cli_fault_set(
            fault, CLI_EXIT_USAGE, "invalid-policy", "%.80s: %.*s", file, length > 0 ? length : 40,
            length > 0 ? child->err : "it takes too long, or needs too much memory");
    }
    *out = json_loads(child->out, JSON_REJECT_DUPLICATES, NULL);
    return json_is_object(*out) ? CLI_EXIT_OK
                                : cli_fault_set(fault, CLI_EXIT_USAGE, "invalid-policy",
                                                "%.80s: the document is not an object", file);
}

/* Without the program, which is in a package of its own, only JSON can be read. */
static enum cli_exit read_json(const char *format, const char *file, int fd, json_t **out,
                               struct cli_fault *fault)
{
    json_error_t where;

    if (strcmp(format, "json") != 0) {
        return cli_fault_set(fault, CLI_EXIT_NOT_FOUND, "no-file",
                             "%.80s: only JSON can be read without the package "
                             "isotherm-policy-import",
                             file);
    }
    *out = json_loadfd(fd, JSON_REJECT_DUPLICATES, &where);
    if (!*out) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "invalid-policy", "%.80s: line %d: %.100s",
                             file, where.line, where.text);
    }
    return json_is_object(*out) ? CLI_EXIT_OK
                                : cli_fault_set(fault, CLI_EXIT_USAGE, "invalid-policy",
                                                "%.80s: the document is not an object", file);
}

/* Lets the program read the file. */
static enum cli_exit let_read(const char *const argv[], const char *file, int fd, json_t **out,
                              struct cli_fault *fault)
{
    struct cli_child child = {0};
    enum cli_exit exit = cli_child_feed(argv, fd, OUTPUT_MAX_BYTES, &child, fault);

    if (!exit) {
        exit = take_answer(&child, file, out, fault);
        cli_child_done(&child);
    }
    return exit;
}

enum cli_exit cli_policy_read_file(const char *program, const char *file, const char *zone,
                                   json_t **out, bool *is_calendar, struct cli_fault *fault)
{
    const char *format = format_of(file);
    const char *const argv[] = {program, format, zone, NULL};
    int fd = -1;

    if (!format) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                             "%.150s: the name must end with .json, .toml or .ics", file);
    }
    if (zone && strcmp(format, "ics") != 0) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                             "--zone is for a calendar: a schedule of a policy names its own");
    }
    enum cli_exit exit = open_file(file, &fd, fault);
    if (exit) {
        return exit;
    }
    json_t *document = NULL;
    exit = access(program, X_OK) ? read_json(format, file, fd, &document, fault)
                                 : let_read(argv, file, fd, &document, fault);
    (void)close(fd);
    if (exit) {
        json_decref(document);
        return exit;
    }
    *out = document;
    *is_calendar = strcmp(format, "ics") == 0;
    return CLI_EXIT_OK;
}

/* The position of the record of a token, or the size of the list. */
static size_t position_of(const json_t *list, const char *token)
{
    size_t i = 0;

    for (; i < json_array_size(list); i++) {
        const char *other = json_string_value(json_object_get(json_array_get(list, i), "token"));
        if (token && other && strcmp(token, other) == 0) {
            break;
        }
    }
    return i;
}

static bool merge_list(json_t *policy, const json_t *calendar, const char *name)
{
    const json_t *added = json_object_get(calendar, name);
    size_t i;
    json_t *record;

    if (json_array_size(added) == 0) {
        return true;
    }
    if (!json_object_get(policy, name) && json_object_set_new(policy, name, json_array()) != 0) {
        return false;
    }
    json_t *list = json_object_get(policy, name);
    json_array_foreach(added, i, record)
    {
        const size_t at = position_of(list, json_string_value(json_object_get(record, "token")));
        const int failed = at < json_array_size(list) ? json_array_set(list, at, record)
                                                      : json_array_append(list, record);
        if (failed) {
            return false;
        }
    }
    return true;
}

bool cli_policy_merge(json_t *policy, const json_t *calendar)
{
    return merge_list(policy, calendar, "special_day_groups") &&
           merge_list(policy, calendar, "schedules");
}
