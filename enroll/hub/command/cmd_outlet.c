/* outlet: where the events go out of the hub. */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/file.h"
#include "enroll/hub/command/hub_command.h"
#include "enroll/hub/outlet/hub_outlet.h"
#include "enroll/hub/outlet/run/hub_outlet_try.h"

enum { FILE_BYTES_MAX = 1 << 20 };

/* The first line of a file, for a secret that must not stand in the list of processes. */
static int read_secret(const char *path, char **out, struct iso_fault *fault)
{
    size_t size = 0;
    const int error = iso_file_read(path, HUB_OUTLET_SECRET_SIZE + 1, out, &size, fault);
    if (!error) {
        (*out)[strcspn(*out, "\r\n")] = '\0';
    }
    return error;
}

static void wipe(char *text)
{
    if (text) {
        sodium_memzero(text, strlen(text));
        free(text);
    }
}

static int add(struct hub_run *run)
{
    const struct hub_arguments *a = &run->arguments;
    struct hub_outlet_options options = {.name = a->words[0],
                                         .address = a->words[2],
                                         .kind = HUB_OUTLET_WEBHOOK,
                                         .events = a->event,
                                         .from_beginning = a->given & HUB_OPTION_BEGINNING};
    char made[HUB_OUTLET_SECRET_SIZE] = "", *secret = NULL, *ca = NULL;
    size_t size = 0;
    if (strcmp(a->words[1], "syslog") == 0) {
        options.kind = HUB_OUTLET_SYSLOG;
    } else if (strcmp(a->words[1], "webhook") != 0) {
        return iso_fault_set(&run->fault, -EINVAL, "%s: is neither webhook nor syslog",
                             a->words[1]);
    }
    int error = a->secret_file ? read_secret(a->secret_file, &secret, &run->fault) : 0;
    error = error || !a->ca ? error : iso_file_read(a->ca, FILE_BYTES_MAX, &ca, &size, &run->fault);
    options.secret = secret;
    options.ca = ca;
    error = error ? error : hub_outlet_add(&run->store, &options, made, &run->fault);
    if (!error && *made && !secret) {
        printf("The secret, which is shown only now: %s\n", made);
    }
    sodium_memzero(made, sizeof made);
    wipe(secret);
    free(ca);
    return error;
}

static int print_outlet(void *context, const struct hub_outlet *o)
{
    char last[HUB_TIME_TEXT_SIZE], next[HUB_TIME_TEXT_SIZE];
    (void)context;
    printf("%-24s %-7s %s\n    events %s  handed over %llu  waiting %llu  last %s\n", o->name,
           hub_outlet_kind_word(o->kind), o->address, *o->events ? o->events : "all",
           (unsigned long long)o->delivered, (unsigned long long)o->waiting,
           hub_time_text(o->delivered_s, last));
    if (o->stopped) {
        printf("    STOPPED: %s; isotherm-hub outlet resume %s\n", o->trouble, o->name);
    } else if (o->failures > 0) {
        printf("    %llu failures: %s; the next attempt is at %s\n",
               (unsigned long long)o->failures, o->trouble, hub_time_text(o->next_attempt_s, next));
    }
    return 0;
}

static int list(struct hub_run *run)
{
    return hub_outlet_each(&run->store, print_outlet, NULL, &run->fault);
}

static int remove_outlet(struct hub_run *run)
{
    return hub_outlet_remove(&run->store, run->arguments.words[0], &run->fault);
}

static int resume(struct hub_run *run)
{
    return hub_outlet_resume(&run->store, run->arguments.words[0], &run->fault);
}

static int test(struct hub_run *run)
{
    const int error = hub_outlet_try(&run->store, run->arguments.words[0], &run->fault);
    if (!error) {
        printf("%s: the event \"test\" was taken\n", run->arguments.words[0]);
    }
    return error;
}

const struct hub_command hub_outlet_commands[] = {
    HUB_COMMAND("outlet add",
                "NAME webhook|syslog ADDRESS [--event EVENT,...] [--secret-file FILE] [--ca FILE] "
                "[--from-beginning]",
                "hand the events of the doors over to another system",
                HUB_OPTION_EVENT | HUB_OPTION_SECRET_FILE | HUB_OPTION_CA | HUB_OPTION_BEGINNING, 3,
                3, add),
    HUB_COMMAND("outlet list", "", "list the outlets, and how far they have come", 0, 0, 0, list),
    HUB_COMMAND("outlet test", "NAME", "hand over an event that says it is a test", 0, 1, 1, test),
    HUB_COMMAND("outlet resume", "NAME", "let an outlet go on that was stopped or waits", 0, 1, 1,
                resume),
    HUB_COMMAND("outlet remove", "NAME", "remove an outlet", 0, 1, 1, remove_outlet),
    {.words = NULL},
};
