// Sanitizer builds only: plug-ins stay mapped, so that LeakSanitizer can name them and lsan.supp can match.
// (Open MPI closes its plug-ins in MPI_Finalize; their leaks would be "<unknown module>" ever after.)
extern "C" int dlclose(void* /*handle*/) { return 0; }
