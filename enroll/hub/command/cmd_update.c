/* update: the image of the doors, brought to a zone in stages. */
#include <errno.h>
#include <stdio.h>

#include "enroll/hub/command/hub_command.h"
#include "enroll/hub/update/update_keep.h"

enum { MIB = 1 << 20 };

static int add(struct hub_run *run)
{
    struct hub_update_file file;
    const int error = hub_update_keep(&run->store, run->arguments.words[0], &file, &run->fault);
    if (!error) {
        printf("version %s for %s, %.1f MiB\n", file.version, file.board, (double)file.size / MIB);
    }
    return error;
}

static int remove_version(struct hub_run *run)
{
    return hub_update_remove(&run->store, run->arguments.words[0], &run->fault);
}

static int roll(struct hub_run *run)
{
    const struct hub_arguments *a = &run->arguments;
    const struct hub_rollout_options options = {
        .version = a->words[0],
        .zone = a->n_zones == 1 ? a->zones[0] : NULL,
        .first = a->given & HUB_OPTION_FIRST ? a->first : HUB_UPDATE_FIRST,
        .stop_after = a->stop_after,
        .wait_s = a->wait_s,
    };
    return options.zone
               ? hub_rollout_start(&run->store, &options, &run->fault)
               : iso_fault_set(&run->fault, -EINVAL, "a rollout needs one zone: --zone ZONE");
}

static int stop(struct hub_run *run)
{
    return hub_rollout_stop(&run->store, run->arguments.words[0], NULL, &run->fault);
}

static int resume(struct hub_run *run)
{
    return hub_rollout_resume(&run->store, run->arguments.words[0], NULL, &run->fault);
}

static int print_file(void *context, const struct hub_update_file *file)
{
    char text[HUB_TIME_TEXT_SIZE];
    (void)context;
    printf("%-20s %-28s %8.1f MiB  added %s\n", file->version, file->board,
           (double)file->size / MIB, hub_time_text(file->added_s, text));
    return 0;
}

static int print_rollout(void *context, const struct hub_rollout *r)
{
    char text[HUB_TIME_TEXT_SIZE];
    (void)context;
    printf("%-20s zone %s: %s%s%s%s, stage %lld, since %s\n"
           "    %lld doors: %lld healthy, %lld failed, %lld at work, %lld waiting, %lld unable\n",
           r->version, r->zone, hub_rollout_state_word(r->stage.state), *r->why ? " (" : "", r->why,
           *r->why ? ")" : "", (long long)r->stage.stage, hub_time_text(r->started_s, text),
           (long long)r->doors, (long long)r->healthy, (long long)r->count.failed,
           (long long)(r->count.told - r->count.finished), (long long)r->count.waiting,
           (long long)r->unable);
    return 0;
}

static int list(struct hub_run *run)
{
    const int error = hub_update_each(&run->store, print_file, NULL, &run->fault);
    return error ? error : hub_rollout_each(&run->store, print_rollout, NULL, &run->fault);
}

static int print_door(void *context, const struct hub_rollout_door *door)
{
    char changed[HUB_TIME_TEXT_SIZE], reported[HUB_TIME_TEXT_SIZE];
    (void)context;
    printf("%-24s %-10s since %s  last report %s%s%s\n", door->name, door->state,
           hub_time_text(door->changed_s, changed), hub_time_text(door->reported_s, reported),
           *door->fault ? "  " : "", door->fault);
    return 0;
}

static int show(struct hub_run *run)
{
    return hub_rollout_doors(&run->store, run->arguments.words[0], print_door, NULL, &run->fault);
}

const struct hub_command hub_update_commands[] = {
    HUB_COMMAND("update add", "FILE", "keep an update of the image of doors", 0, 1, 1, add),
    HUB_COMMAND("update remove", "VERSION", "delete the files of a version", 0, 1, 1,
                remove_version),
    HUB_COMMAND("update roll", "VERSION --zone ZONE [--first N] [--stop-after N] [--wait SECONDS]",
                "bring a version to the doors of a zone, in stages",
                HUB_OPTION_ZONE | HUB_OPTION_FIRST | HUB_OPTION_STOP_AFTER | HUB_OPTION_WAIT, 1, 1,
                roll),
    HUB_COMMAND("update list", "", "list the versions, and how far the zones are with them", 0, 0,
                0, list),
    HUB_COMMAND("update show", "ZONE", "show how far each door of a zone is", 0, 1, 1, show),
    HUB_COMMAND("update stop", "ZONE", "stop the rollout of a zone", 0, 1, 1, stop),
    HUB_COMMAND("update resume", "ZONE",
                "let a stopped rollout go on; what has failed does not count any more", 0, 1, 1,
                resume),
    {.words = NULL},
};
