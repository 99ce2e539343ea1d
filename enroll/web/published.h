/* What the web server tells other programs of this machine, for the screen at the door: the
 * fingerprint of its certificate, and the code for the first account. */
#ifndef WEB_PUBLISHED_H
#define WEB_PUBLISHED_H

/* Writes the fingerprint to the file "fingerprint" of the folder that systemd has made for the
 * service (RuntimeDirectory=), readable for everybody. Without such a folder it does nothing. If
 * the file cannot be written, it prints a line: the pages work without it. */
void web_published_write(const char *fingerprint);

/* Writes the code to the file "setup-code" of the same folder. The group of the server may read it,
 * in which the screen of an image is, and nobody else. */
void web_published_write_code(const char *code);

/* Removes this file; one that is not there is accepted. */
void web_published_remove_code(void);

#endif
