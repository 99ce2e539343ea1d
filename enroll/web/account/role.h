/* What an account of the web server may do. Each role may also do what the roles before it may.
 *
 *   observer       sees the door: its state, its outline and who comes
 *   enroller       also lists people and enrols them
 *   administrator  also renames and removes people, limits their times, reads the log, closes the
 *                  door to everybody, and manages the accounts */
#ifndef WEB_ACCOUNT_ROLE_H
#define WEB_ACCOUNT_ROLE_H

/* The all-zero value may do nothing but log in. */
enum web_role { WEB_ROLE_NONE = 0, WEB_ROLE_OBSERVER, WEB_ROLE_ENROLLER, WEB_ROLE_ADMINISTRATOR };

/* The word of a role: "none", "observer", ... */
const char *web_role_word(enum web_role role);

/* The role of a word; WEB_ROLE_NONE if it is not the word of a role. "none" is not accepted. */
enum web_role web_role_of(const char *word);

#endif
