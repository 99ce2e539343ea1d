/* import, directory: people whom a directory names. */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/file.h"
#include "enroll/hub/command/hub_command.h"
#include "enroll/hub/directory/hub_ldap.h"
#include "enroll/hub/scim/hub_scim.h"
#include "enroll/hub/store/hub_zone.h"

enum { PASSWORD_BYTES_MAX = 1024, GROUP_SIZE = 512 };

static const char source[] = "ldap";

/* Reads GROUP=ZONE of --zone; a distinguished name has equal signs, so the last one divides. */
static int take_group(struct hub_run *run, const char *text, char group[GROUP_SIZE],
                      struct hub_ldap_group *out)
{
    const char *equals = strrchr(text, '=');
    struct hub_zone zone;
    if (!equals || equals == text || equals - text >= GROUP_SIZE) {
        return iso_fault_set(&run->fault, -EINVAL, "--zone: %s is not GROUP=ZONE", text);
    }
    const int error = hub_zone_find(&run->store, equals + 1, &zone, &run->fault);
    if (!error) {
        (void)snprintf(group, GROUP_SIZE, "%.*s", (int)(equals - text), text);
        *out = (struct hub_ldap_group){.group = group, .zone = zone.place.zone};
    }
    return error;
}

static void tell(void *context, enum hub_directory_change change, const char *name, const char *why)
{
    (void)context;
    printf("%-8s %s%s%s\n", hub_directory_change_word(change), name, *why ? ": " : "", why);
}

static int sync_all(struct hub_run *run, const struct hub_named *named, size_t n)
{
    const struct hub_arguments *a = &run->arguments;
    const struct hub_directory_run options = {.source = source,
                                              .dry_run = a->given & HUB_OPTION_DRY_RUN,
                                              .force = a->given & HUB_OPTION_FORCE,
                                              .tell = tell};
    struct hub_directory_counts c = {.named = 0};
    const int error = hub_directory_sync(&run->store, &options, named, n, &c, &run->fault);
    if (error) {
        return error;
    }
    printf("%s%llu people: %llu added, %llu changed, %llu linked, %llu removed, %llu failed\n",
           options.dry_run ? "dry run: " : "", (unsigned long long)c.named,
           (unsigned long long)c.added, (unsigned long long)c.changed, (unsigned long long)c.linked,
           (unsigned long long)c.removed, (unsigned long long)c.failed);
    run->unconfirmed = c.failed > 0;
    return 0;
}

static int import(struct hub_run *run)
{
    const struct hub_arguments *a = &run->arguments;
    static char names[HUB_PERSON_ZONES_MAX][GROUP_SIZE];
    static struct hub_ldap_group groups[HUB_PERSON_ZONES_MAX];
    struct hub_ldap_options options = {.uri = a->uri,
                                       .base = a->base,
                                       .filter = a->filter,
                                       .map = a->map,
                                       .bind = a->bind,
                                       .ca_file = a->ca,
                                       .groups = groups,
                                       .n_groups = a->n_zones};
    char *password = NULL;
    struct hub_named *named = NULL;
    size_t size = 0, n = 0;
    int error = a->uri && a->base
                    ? 0
                    : iso_fault_set(&run->fault, -EINVAL, "--uri and --base have to be given");
    for (size_t i = 0; !error && i < a->n_zones; i++) {
        error = take_group(run, a->zones[i], names[i], &groups[i]);
    }
    if (!error && a->secret_file) {
        error = iso_file_read(a->secret_file, PASSWORD_BYTES_MAX, &password, &size, &run->fault);
    }
    if (password) {
        password[strcspn(password, "\r\n")] = '\0';
        options.password = password;
    }
    error = error ? error : hub_ldap_read(&options, &named, &n, &run->fault);
    error = error ? error : sync_all(run, named, n);
    if (password) {
        sodium_memzero(password, size);
    }
    free(password);
    free(named);
    return error;
}

static int print_entry(void *context, const struct hub_directory_entry *entry)
{
    (void)context;
    printf("%-32s %-36s %s\n", entry->named.name, entry->named.external,
           !entry->is_named       ? "not named any more"
           : !entry->named.active ? "disabled"
           : entry->is_linked     ? "enrolled"
                                  : "must be enrolled");
    return 0;
}

static int list(struct hub_run *run)
{
    return hub_directory_each(&run->store, print_entry, NULL, &run->fault);
}

static int link_by_hand(struct hub_run *run)
{
    struct hub_person person;
    const char *id = run->arguments.words[0];
    int error = hub_person_find(&run->store, run->arguments.words[1], &person, &run->fault);
    if (error) {
        return error;
    }
    error = hub_directory_link(&run->store, source, id, &person.id, &run->fault);
    return error == -ENOENT
               ? hub_directory_link(&run->store, HUB_SCIM_SOURCE, id, &person.id, &run->fault)
               : error;
}

const struct hub_command hub_directory_commands[] = {
    HUB_COMMAND(
        "import ldap",
        "--uri URI --base DN [--filter FILTER] [--map NAME=ATTRIBUTE,...] [--zone GROUP=ZONE]... "
        "[--bind DN --secret-file FILE] [--ca FILE] [--dry-run] [--force]",
        "take names, zones and validity of people from an LDAP directory",
        HUB_OPTION_URI | HUB_OPTION_BASE | HUB_OPTION_FILTER | HUB_OPTION_MAP | HUB_OPTION_ZONE |
            HUB_OPTION_BIND | HUB_OPTION_SECRET_FILE | HUB_OPTION_CA | HUB_OPTION_DRY_RUN |
            HUB_OPTION_FORCE,
        0, 0, import),
    HUB_COMMAND("directory list", "",
                "list the people whom a directory names, and who must be enrolled", 0, 0, 0, list),
    HUB_COMMAND("directory link", "ID PERSON",
                "say that a person of the fleet is one of the directory", 0, 2, 2, link_by_hand),
    {.words = NULL},
};
