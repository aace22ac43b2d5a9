/* Directories for RTKLIB's common file; what uses them is not linked. */
#ifndef POSIX_DIRENT_H
#define POSIX_DIRENT_H
typedef int DIR;
struct dirent {
    char d_name[1];
};
DIR *opendir(const char *name);
struct dirent *readdir(DIR *directory);
int closedir(DIR *directory);
#endif
