#include "enroll/pam/arguments.h"

#include <errno.h>
#include <string.h>

/* A face shows no intent: whoever sits before the camera has not agreed to what a program asks root
 * for. At a login or an unlocked screen the person has come for that. */
static const char rights[] = "sudo,sudo-i,su,su-l,polkit-1,doas,pkexec,chfn,chsh,passwd";

/* Copies the value if the argument has this name and was not read before: 1; else 0, or -EINVAL. */
static int take(const char *argument, const char *name, const char **value)
{
    const size_t length = strlen(name);
    if (strncmp(argument, name, length) != 0 || argument[length] != '=') {
        return 0;
    }
    if (*value || !argument[length + 1]) {
        return -EINVAL;
    }
    *value = argument + length + 1;
    return 1;
}

static bool begins_with(const char *text, const char *start)
{
    const size_t length = strlen(start);
    return strncmp(text, start, length) == 0 && text[length];
}

/* One or two digits. */
static int parse_timeout(const char *text)
{
    int seconds = 0;
    for (size_t i = 0; text[i]; i++) {
        if (i == 2 || text[i] < '0' || text[i] > '9') {
            return -EINVAL;
        }
        seconds = 10 * seconds + (text[i] - '0');
    }
    return seconds >= 1 && seconds <= LOGIN_TIMEOUT_MAX_S ? seconds : -EINVAL;
}

static int read_all(int argc, const char *const argv[], struct login_arguments *read,
                    const char **timeout, struct iso_fault *fault)
{
    const struct {
        const char *name, **value;
    } known[] = {
        {"bus", &read->bus}, {"users", &read->users}, {"ask", &read->ask}, {"timeout", timeout}};
    for (int i = 0; i < argc; i++) {
        int r = 0;
        for (size_t k = 0; r == 0 && k < sizeof known / sizeof *known; k++) {
            r = take(argv[i], known[k].name, known[k].value);
        }
        if (r <= 0) {
            return iso_fault_set(fault, -EINVAL, "argument %s: %s", argv[i],
                                 r < 0 ? "it has no value, or is there twice" : "it is not known");
        }
    }
    return 0;
}

int login_arguments_read(int argc, const char *const argv[], const char *users,
                         struct login_arguments *out, struct iso_fault *fault)
{
    struct login_arguments read = {.bus = NULL};
    const char *timeout = NULL;
    const int error = read_all(argc, argv, &read, &timeout, fault);
    if (error) {
        return error;
    }
    read.bus = read.bus ? read.bus : LOGIN_SYSTEM_BUS;
    read.users = read.users ? read.users : users;
    read.ask = read.ask ? read.ask : rights;
    read.timeout_s = timeout ? parse_timeout(timeout) : LOGIN_TIMEOUT_S;
    /* Other transports of D-Bus start programs, or go over a network. */
    if (!begins_with(read.bus, "unix:path=/") && !begins_with(read.bus, "unix:abstract=")) {
        return iso_fault_set(
            fault, -EINVAL, "argument bus=%s: not unix:path=/FILE or unix:abstract=NAME", read.bus);
    }
    if (read.users[0] != '/') {
        return iso_fault_set(fault, -EINVAL, "argument users=%s: not an absolute path", read.users);
    }
    if (read.timeout_s < 0) {
        return iso_fault_set(fault, -EINVAL, "argument timeout=%s: not 1 to %d seconds", timeout,
                             LOGIN_TIMEOUT_MAX_S);
    }
    *out = read;
    return 0;
}

bool login_arguments_ask(const struct login_arguments *arguments, const char *service)
{
    const char *at = arguments->ask;
    if (strcmp(at, "none") == 0) {
        return false;
    }
    if (strcmp(at, "all") == 0 || !service) {
        return true;
    }
    const size_t length = strlen(service);
    for (; *at; at += strcspn(at, ",")) {
        at += *at == ',';
        if (strcspn(at, ",") == length && strncmp(at, service, length) == 0) {
            return true;
        }
    }
    return false;
}
