/* scim: what identity providers may tell the hub. */
#include <sodium.h>
#include <stdio.h>

#include "enroll/hub/command/hub_command.h"
#include "enroll/hub/scim/hub_scim.h"

static int make_token(struct hub_run *run)
{
    char token[HUB_SCIM_TOKEN_SIZE];
    const int error = hub_scim_token_make(&run->store, run->arguments.words[0], token, &run->fault);
    if (!error) {
        printf("address: https://%s:%u/scim/v2\ntoken, which is shown only now: %s\n",
               run->config.host, run->config.port, token);
        sodium_memzero(token, sizeof token);
    }
    return error;
}

static int revoke_token(struct hub_run *run)
{
    return hub_scim_token_revoke(&run->store, run->arguments.words[0], &run->fault);
}

static int print_token(void *context, const struct hub_scim_token *token)
{
    char added[HUB_TIME_TEXT_SIZE], used[HUB_TIME_TEXT_SIZE];
    (void)context;
    printf("token %-32s made %s  used %s\n", token->name, hub_time_text(token->added_s, added),
           hub_time_text(token->used_s, used));
    return 0;
}

static int print_group(void *context, const struct hub_scim_group_zone *entry)
{
    (void)context;
    printf("group %-32s %s", entry->group, *entry->zone ? entry->zone : "no zone");
    if (entry->exists) {
        printf("  %lld people\n", (long long)entry->members);
    } else {
        printf("  not known to an identity provider\n");
    }
    return 0;
}

static int list(struct hub_run *run)
{
    const int error = hub_scim_token_each(&run->store, print_token, NULL, &run->fault);
    return error ? error : hub_scim_zones_each(&run->store, print_group, NULL, &run->fault);
}

static int set_zones(struct hub_run *run)
{
    struct iso_fleet_id zones[HUB_PERSON_ZONES_MAX];
    const int error = hub_run_zones(run, zones);
    return error ? error
                 : hub_scim_zones_set(&run->store, run->arguments.words[0], zones,
                                      run->arguments.n_zones, &run->fault);
}

static int allow(struct hub_run *run)
{
    return hub_scim_allow(&run->store, &run->fault);
}

const struct hub_command hub_scim_commands[] = {
    HUB_COMMAND("scim token", "NAME", "make a token with which an identity provider may ask", 0, 1,
                1, make_token),
    HUB_COMMAND("scim revoke", "NAME", "revoke a token", 0, 1, 1, revoke_token),
    HUB_COMMAND("scim list", "", "list tokens, groups and their zones", 0, 0, 0, list),
    HUB_COMMAND("scim zone", "GROUP [--zone ZONE]...", "say which zones a group gives",
                HUB_OPTION_ZONE, 1, 1, set_zones),
    HUB_COMMAND("scim allow", "", "let people lose their zones without a limit for an hour", 0, 0,
                0, allow),
    {.words = NULL},
};
