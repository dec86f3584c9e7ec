# What Debian's policy wants of the files that cpack is about to pack: a compressed manual page, copyright, changelog.
set(usr ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/ALL_COMPONENTS_IN_ONE/usr)

# Without time stamp and name.
function(compress file)
  execute_process(COMMAND gzip -9nf ${file} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

compress(${usr}/share/man/man1/raycone.1)

set(doc ${usr}/share/doc/raycone)
file(MAKE_DIRECTORY ${doc})
file(COPY ${CPACK_RAYCONE_COPYRIGHT} DESTINATION ${doc})
execute_process(COMMAND date --utc --rfc-email --date=${CPACK_RAYCONE_RELEASE_DATE}
                OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
file(WRITE ${doc}/changelog
     "raycone (${CPACK_DEBIAN_PACKAGE_VERSION}) stable; urgency=medium\n\n"
     "  * Version ${CPACK_PACKAGE_VERSION}: docs/changelog.md of the sources.\n\n"
     " -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
compress(${doc}/changelog)
