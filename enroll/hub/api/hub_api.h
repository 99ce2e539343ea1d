/* The JSON API of the hub for its administrators, below /api/v1 of the hub's HTTPS. Accounts,
 * roles, sessions and problems are those of isotherm-web (enroll/web/account, session and http);
 * the accounts are the hub's own. What an account does is recorded by the store under its name.
 *
 *   GET    /session                    who is logged in
 *   POST   /session                    {"account", "password"}: logs in
 *   DELETE /session
 *   POST   /setup                      {"code", "account", "password"}: the first administrator
 *   GET    /zones                      observer
 *   PUT    /zones/{name}/lockdown      {"on"}: administrator
 *   PUT    /lockdown                   {"on"}: all zones, in one transaction
 *   GET    /doors                      observer: zones, report, and whether each has confirmed
 *   GET    /people?search=&zone=&most= enroller
 *   DELETE /people/{id}                administrator: revokes the person in all zones
 *   GET    /requests                   enroller
 *   POST   /requests/{id}/approve      administrator
 *   POST   /requests/{id}/reject       administrator
 *   GET    /events?door=&person=&event=&since=&most=   administrator: who was where
 *   GET    /acts?most=                 administrator: who has changed what */
#ifndef HUB_API_HUB_API_H
#define HUB_API_HUB_API_H

#include <limits.h>

#include "enroll/hub/api/bucket.h"
#include "enroll/hub/store/hub_store.h"
#include "enroll/web/account/account.h"
#include "enroll/web/account/guess.h"
#include "enroll/web/http/route.h"
#include "enroll/web/session/session.h"

/* The context of all handlers. One thread. */
struct hub_api {
    struct hub_store *store;
    struct web_accounts *accounts;
    struct web_sessions sessions;
    struct web_guess guess;
    struct hub_bucket
        logins; /* a check of a password takes a tenth of a second of the event loop */
    char setup_code[PATH_MAX];
};

/* All routes; ends with a method of NULL. */
extern const struct web_route hub_api_routes[];

/* Reads the accounts: `folder`/accounts.json. The one-time code of the first account is in
 * `folder`/setup.code (enroll/web/account/setup_code.h). The errors of web_accounts_open(). */
int hub_api_open(struct hub_api *api, struct hub_store *store, const char *folder,
                 struct iso_fault *fault) __attribute__((warn_unused_result));

/* Wipes sessions and accounts. An API of zeros is accepted. */
void hub_api_close(struct hub_api *api);

/* Makes a one-time code for an administrator's account, which is valid for a day. */
enum { HUB_API_CODE_SIZE = 24 };
int hub_api_make_code(const char *folder, char code[HUB_API_CODE_SIZE], struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
