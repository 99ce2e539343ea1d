/* The text of openapi.json, which the build puts into the program. */
#ifndef WEB_API_DOCUMENT_H
#define WEB_API_DOCUMENT_H

/* UTF-8 with a NUL at its end. */
extern const unsigned char web_api_document[];

#endif
